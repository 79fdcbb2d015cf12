"""The loop feeds the core, in order, and lets time pass."""

import sys
import threading
from contextlib import ExitStack
from functools import partial

import pytest

from proxy import clock
from proxy.core.core import Core
from proxy.core.interface.commands import Forward, Notice, SendState
from proxy.core.interface.events import (
    ClockChanged,
    PeerAppeared,
    SampleHanded,
    SampleHeard,
    SamplePublished,
    TimePassed,
)
from proxy.core.model.settings import CoreSettings
from proxy.loop import Loop
from proxy.tuning import TUNING
from tests.waiting import wait_until
from utility_specs import Specs


@pytest.fixture
def executed():
    return []


@pytest.fixture
def loop(executed):
    core = Core(CoreSettings("r1", "z1"), Specs.empty(), clock.monotonic())
    with ExitStack() as stack:
        made = Loop(core, executed.append)
        made.start()
        stack.callback(made.close, 1.0)
        yield made


def texts(executed):
    return [command.text for command in executed if isinstance(command, Notice)]


def test_events_become_commands_in_order(loop, executed):
    """What the core answers is carried out, event by event."""
    for name in ("r2", "r3"):
        loop.post(PeerAppeared(clock.monotonic(), name, f"z-{name}"))
    wait_until(lambda: len(texts(executed)) == 2, what="both notices")
    assert texts(executed) == ["robot r2 is on the mesh", "robot r3 is on the mesh"]


@pytest.mark.usefixtures("loop")
def test_time_passes_without_events(executed):
    """The first state is sent though nothing has happened."""
    wait_until(lambda: any(isinstance(command, SendState) for command in executed), what="a state")


def test_jobs_run_on_the_loops_thread_and_may_make_events(loop, executed):
    """A function is run by the loop; what it returns is handled as an event."""
    ran = []

    def job():
        ran.append(threading.current_thread().name)
        return PeerAppeared(clock.monotonic(), "r2", "z2")

    loop.post(job)
    loop.post(lambda: ran.append("nothing"))
    wait_until(lambda: len(ran) == 2 and texts(executed), what="the jobs")
    assert ran == ["loop", "nothing"]
    assert texts(executed) == ["robot r2 is on the mesh"]


def test_jobs_run_when_their_time_has_come(loop, monkeypatch):
    """In the order of their times, not of their posting, and after what is due at once."""
    now, ran = clock.monotonic(), []
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now)
    for name, delay in (("last", 0.04), ("first", 0.02), ("second", 0.02)):
        loop.post_at(now + delay, partial(ran.append, name))
    loop.post(partial(ran.append, "at once"))
    wait_until(lambda: ran == ["at once"], what="what is due at once")
    now += 0.03
    wait_until(lambda: ran == ["at once", "first", "second"], what="what is due then")
    now += 0.03
    wait_until(lambda: ran == ["at once", "first", "second", "last"], what="the last one")


@pytest.mark.parametrize("error", [RuntimeError, SystemExit])
def test_what_cannot_be_handled_is_counted_and_the_loop_goes_on(loop, executed, caplog, error):
    """A fault is logged and counted, and the next event is handled."""

    def broken():
        raise error("broken")

    loop.post(broken)
    loop.post(PeerAppeared(clock.monotonic(), "r2", "z2"))
    wait_until(lambda: texts(executed), what="the event after it")
    assert loop.feed.faults == 1
    assert "broken" in caplog.text


def test_what_may_be_left_out_is_when_the_loop_is_behind(executed):
    """Samples of apps always wait their turn; what others say, and say again, is refused and counted."""
    loop = Loop(Core(CoreSettings("r1", "z1"), Specs.empty(), 0.0), executed.append)
    offered = [loop.offer(TimePassed(0.0)) for _ in range(TUNING.items + 3)]
    assert (sum(offered), loop.refused) == (TUNING.items, 3)
    loop.post(PeerAppeared(clock.monotonic(), "r2", "z2"))
    assert loop.waiting == TUNING.items + 1
    loop.start()
    wait_until(lambda: texts(executed), what="the event that must not be lost")
    assert loop.offer(TimePassed(0.0))
    loop.close(5.0)


def test_closing_handles_what_waits(executed):
    """Events posted before the end are handled; afterwards the thread is gone."""
    loop = Loop(Core(CoreSettings("r1", "z1"), Specs.empty(), 0.0), executed.append)
    for i in range(20):
        loop.post(PeerAppeared(clock.monotonic(), f"p{i}", f"z-p{i}"))
    loop.post(TimePassed(clock.monotonic()))
    assert loop.waiting == 21
    loop.start()
    loop.close(5.0)
    assert len(texts(executed)) == 20
    assert not loop._thread.is_alive()


def test_the_core_learns_what_the_wall_clock_shows(executed):
    """Within about a second: a core that was told another time at start tells the others."""
    core = Core(CoreSettings("r1", "z1", wall_offset=-60.0), Specs.empty(), clock.monotonic())
    loop = Loop(core, executed.append)
    loop.start()
    try:
        wait_until(lambda: states(executed) and states(executed)[-1].wall_offset != -60.0, what="a state")
        assert abs(states(executed)[-1].wall_offset - clock.wall_offset()) < 0.1
    finally:
        loop.close(1.0)


def states(executed):
    return [command.state for command in executed if isinstance(command, SendState)]


def test_who_asks_gets_what_the_job_returns(loop):
    """It has run on the loop's thread by then."""
    assert loop.ask(lambda: threading.current_thread().name, 20.0) == "loop"


def test_who_asks_hears_that_the_job_failed(loop):
    """It is a fault of the daemon, too, which goes on."""
    with pytest.raises(ZeroDivisionError):
        loop.ask(lambda: 1 // 0, 20.0)
    assert loop.ask(lambda: 3, 20.0) == 3


def test_who_asks_does_not_wait_for_ever(loop):
    """What takes longer may still be done."""
    began, end = threading.Event(), threading.Event()
    loop.post(lambda: began.set() or (end.wait(20.0) and None))
    assert began.wait(20.0)
    with pytest.raises(TimeoutError):
        loop.ask(lambda: None, 0.01)
    end.set()
    assert loop.ask(lambda: 3, 20.0) == 3


def test_orders_come_before_samples_that_wait(loop):
    """An operator's question is not behind what a daemon has not come to."""
    ran, began, go = [], threading.Event(), threading.Event()
    loop.post(lambda: began.set() or (go.wait(20.0) and None))
    assert began.wait(20.0)
    for number in range(100):
        loop.post(partial(ran.append, number))
    loop.order(partial(ran.append, "order"))
    go.set()
    wait_until(lambda: len(ran) == 101, what="all jobs")
    assert ran == ["order", *range(100)]


def test_what_is_noted_comes_with_what_happens_next(executed):
    """It does not wake the loop, comes before what is posted later, and in a moment by itself."""
    core, taken = Core(CoreSettings("r1", "z1"), Specs.empty(), clock.monotonic()), []
    loop = Loop(core, executed.append)

    class Taker:
        """Takes in everything."""

        def handle(self, event):
            taken.append(event)
            return []

        def pass_on(self, _event):
            return None

    loop.feed.record(Taker())
    loop.start()
    try:
        for _ in range(2):  # after the first one the loop has looked what the core only notes
            loop.ask(lambda: None, 20.0)
        heard = [SampleHeard(clock.monotonic(), f"a/{number}", 10, None, None, None) for number in range(3)]
        posted = PeerAppeared(clock.monotonic(), "r2", "z2")
        for event in heard[:2]:
            loop.note(event)
        loop.post(posted)
        wait_until(lambda: posted in taken, what="what was posted")
        assert [event for event in taken if not isinstance(event, TimePassed | ClockChanged)] == [*heard[:2], posted]
        loop.note(heard[2])
        wait_until(lambda: heard[2] in taken, what="what was noted last")
    finally:
        loop.close(1.0)


def test_what_is_due_comes_before_all_that_waits(loop):
    """A deadline must not wait behind a hundred events."""
    ran = []

    def first():
        loop.at(clock.monotonic(), partial(ran.append, "due"))

    def both():
        loop.post(first)
        for number in range(100):
            loop.post(partial(ran.append, number))

    loop.post(both)
    wait_until(lambda: len(ran) == 101, what="all jobs")
    assert ran == ["due", *range(100)]


class Passing:
    """Has samples passed on, and notes which it was handed, and on which thread. Time passes in a core."""

    def __init__(self):
        self.core = Core(CoreSettings("r1", "z1"), Specs.empty(), clock.monotonic())
        self.taken = []
        self.held = threading.Event()
        self.held.set()

    def handle(self, event):
        if isinstance(event, TimePassed | ClockChanged):
            return self.core.handle(event)
        assert self.held.wait(60.0)
        self._note("handled", event)
        return []

    def pass_on(self, event):
        if isinstance(event, SampleHanded):
            self._note("passed", event)
            return []
        if event.key == "a/b":
            self._note("passed", event)
            return [Forward(event.sample)]
        return None

    def _note(self, what, event):
        self.taken.append((what, event.sample, threading.current_thread().name))


@pytest.fixture
def passing():
    return Passing()


@pytest.fixture
def led(passing):
    """A loop whose commands say at once that the sample was handed over."""

    def execute(command):
        if not isinstance(command, SendState):
            loop.post(SampleHanded(clock.monotonic(), -command.sample))

    loop = Loop(passing.core, execute)
    loop.feed.record(passing)
    loop.start()
    yield loop
    passing.held.set()
    loop.close(5.0)


def sample(number, key="a/b"):
    return SamplePublished(clock.monotonic(), number, key, 10, 0.0, None, 5, {})


def test_who_brings_a_sample_that_goes_on_needs_no_other_thread(led, passing):
    """He has the core take it in, and that it was handed over, once the loop waits for something to do."""
    here = threading.current_thread().name
    wait_until(lambda: led.lead(sample(1)), what="the lease of the core")
    assert passing.taken == [("passed", 1, here), ("passed", -1, here)]


def test_what_the_core_does_not_pass_on_is_not_taken_in(led, passing):
    """Then it has to be posted like all else."""
    wait_until(lambda: led.lead(sample(1)), what="the lease of the core")
    other = sample(2, "c")
    assert not led.lead(other)
    led.post(other)
    wait_until(lambda: passing.taken[-1] == ("handled", 2, "loop"), what="the other sample")


def test_no_sample_overtakes_what_waits(led, passing):
    """While the loop's thread is in the core, or anything waits for it, samples wait behind that."""
    wait_until(lambda: led.lead(sample(1)), what="the lease of the core")
    passing.held.clear()
    led.post(sample(2))
    assert not led.lead(sample(3))
    led.post(sample(3))
    passing.held.set()
    wait_until(lambda: len(passing.taken) == 4, what="both samples")
    assert passing.taken[2:] == [("handled", 2, "loop"), ("handled", 3, "loop")]
    led.close(5.0)
    assert not led.lead(sample(4))


def test_a_core_that_chokes_on_a_sample_is_counted(led, passing, monkeypatch, caplog):
    """Whoever brought it goes on, and so does the loop."""
    monkeypatch.setattr(passing, "pass_on", lambda _: [None])
    wait_until(lambda: led.lead(sample(1)), what="the lease of the core")
    assert led.feed.faults == 1
    assert "the core cannot handle SamplePublished" in caplog.text
    led.ask(lambda: None, 20.0)


def test_a_sample_that_ends_its_thread_is_counted(led, passing, monkeypatch):
    """Where an operator's own code calls exit."""
    monkeypatch.setattr(passing, "pass_on", lambda _: sys.exit())
    wait_until(lambda: led.lead(sample(1)), what="the lease of the core")
    assert led.feed.faults == 1


def test_who_brings_a_sample_sees_to_all_that_follows(led, passing):
    """What its decision asks for is done by the same thread, one after the other."""
    here = threading.current_thread().name
    ran = []

    def job():
        led.post(lambda: ran.append(threading.current_thread().name))
        return sample(2, "c")

    wait_until(lambda: led.bring(job), what="the lease of the core")
    assert passing.taken == [("handled", 2, here)]
    assert ran == [here]


def test_nothing_that_is_brought_overtakes_what_waits(led, passing):
    """While the loop's thread is in the core, or anything waits for it, nobody else is."""
    wait_until(lambda: led.bring(sample(1)), what="the lease of the core")
    passing.held.clear()
    led.post(sample(2))
    assert not led.bring(sample(3))
    passing.held.set()
    wait_until(lambda: len(passing.taken) > 1 and led.bring(sample(4)), what="the lease of the core again")
    assert [number for _, number, _ in passing.taken if number > 0] == [1, 2, 4]
    led.close(5.0)
    assert not led.bring(sample(5))


def test_who_brings_a_sample_leaves_the_rest_to_the_loop_when_others_wait(led):
    """However much follows, he is soon back: what came meanwhile has the loop's thread go on."""
    ran, turns = [], iter(range(3))

    def follow():
        ran.append(threading.current_thread().name)
        if next(turns, None) is not None:
            led.post(follow)

    def first():
        led.order(lambda: ran.append("order"))
        led.post(follow)

    wait_until(lambda: led.bring(first), what="the lease of the core")
    wait_until(lambda: len(ran) == 5, what="all that follows")
    assert ran == ["order", *4 * ["loop"]]


def test_what_is_due_sooner_by_what_was_brought_wakes_the_loop(led, monkeypatch):
    """Its thread slept until something much later."""
    ran = threading.Event()
    monkeypatch.setattr(led.core, "wake_at", lambda now: now + 3600.0)
    led.ask(lambda: None, 20.0)
    wait_until(lambda: led.bring(lambda: led.at(clock.monotonic() + 0.05, ran.set)), what="the lease of the core")
    assert ran.wait(20.0)


@pytest.mark.parametrize("noted", [(False, True), (True, False), (True, True)])
def test_what_is_noted_keeps_its_order(noted):
    """Whether the core only notes it changes from one moment to the next; digests of a robot keep their order."""
    core, taken = Core(CoreSettings("r1", "z1"), Specs.empty(), clock.monotonic()), []
    loop = Loop(core, lambda _: None)
    for number, only in enumerate(noted):
        loop.feed.notes = only
        loop.note(partial(taken.append, number))
    loop.start()
    loop.close(20.0)
    assert taken == [0, 1]


def test_what_the_core_only_notes_comes_before_what_is_brought(led, passing, monkeypatch):
    """Whoever brings a sample sees to that, too: the loop's thread need not wake."""
    monkeypatch.setattr(type(led.core), "notes", True)
    monkeypatch.setattr(led.core, "wake_at", lambda now: now + 3600.0)
    here = threading.current_thread().name
    wait_until(lambda: led.bring(sample(1, "c")), what="the lease of the core")
    led.note(sample(2, "c"))
    wait_until(lambda: led.bring(sample(3, "c")), what="the lease of the core")
    assert [number for _, number, _ in passing.taken if number > 0] == [1, 2, 3]
    assert passing.taken[-1] == ("handled", 3, here)
