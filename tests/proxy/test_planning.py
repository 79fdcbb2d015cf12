"""Decisions by their deadline, on a loop with its core."""

from contextlib import ExitStack
from dataclasses import replace

import pytest

from planner import SearchSettings
from proxy import clock
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import State
from proxy.loop import Loop
from proxy.planning import RECENT, Planning
from proxy.tuning import TUNING
from tests.utility_specs.models import Slow
from tests.waiting import wait_until
from utility_specs import load_specs

SPEC = """
[[constraint]]
kind = "throughput"
limit = "120 kbit/s"
window = 1
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = {aggregation}
utility = {{ kind = "video" }}
"""
SLOW = '{ python = "tests.utility_specs.models:Slow" }'


class Driven:
    """A core that is driven as the daemon drives it, with somebody who wants its samples."""

    def __init__(self, stack, path, aggregation, deadline):
        path.write_text(SPEC.format(aggregation=aggregation))
        Slow.may.set()
        settings = CoreSettings("r1", "z-r1", coordination="announce", deadline=deadline)
        self.done, self.samples = [], 0
        self.loop = Loop(Core(settings, load_specs(path), clock.monotonic()), self._execute)
        self.planning = Planning(SearchSettings(), deadline, self.loop)
        self.loop.start()
        for part in (self.planning, self.loop):
            stack.callback(part.close, 1.0)
        stack.callback(Slow.may.set)
        now = clock.monotonic()
        self.loop.post(ev.PeerAppeared(now, "op", "zz-op"))
        self.loop.post(ev.StateHeard(now, State("op", "zz-op", "enforce", "", (), ("robot/*/camera",))))

    def _execute(self, command):
        match command:
            case Decide():
                self.planning.decide(command)
            case Forward() | Drop():
                self.done.append(command)

    def publish(self):
        self.samples += 1
        now = clock.monotonic()
        self.loop.post(ev.SamplePublished(now, self.samples, "robot/r1/camera", 1000, now, None, 5, {}))

    def decisions(self):
        return self.loop.ask(lambda: self.loop.core.status(clock.monotonic())["decisions"], 10.0)


@pytest.fixture
def drive(tmp_path):
    with ExitStack() as stack:
        yield lambda aggregation, deadline: Driven(stack, tmp_path / "specs.toml", aggregation, deadline)


def test_decisions_in_time_are_the_planners(drive):
    """Each sample has its search."""
    driven = drive('"sum"', 20.0)
    for _ in range(3):
        driven.publish()
    wait_until(lambda: len(driven.done) == 3, what="three decisions")
    assert (driven.decisions()["made"], driven.decisions()["late"]) == (3, 0)


def test_the_core_hears_of_each_decision_once(drive, monkeypatch):
    """When its deadline comes the core need not hear again of an answer that it has from another thread."""
    monkeypatch.setattr("proxy.planning.TUNING", replace(TUNING, decided_at_once=-1.0))
    driven = drive('"sum"', 0.5)
    handled, handle = [], driven.loop.feed.handle
    monkeypatch.setattr(driven.loop.feed, "handle", lambda event: handled.append(event) or handle(event))
    for _ in range(3):
        driven.publish()
    wait_until(lambda: len(driven.done) == 3, what="three decisions")
    wait_until(lambda: not driven.loop.waiting, what="the end of their deadlines")
    answers = [event.ticket for event in handled if isinstance(event, ev.DecisionReady | ev.DecisionLate)]
    assert len(answers) == len(set(answers)) == 3


def test_a_search_needs_no_other_thread(drive, monkeypatch):
    """Nor does anybody wait for its deadline."""
    driven = drive('"sum"', 20.0)
    monkeypatch.setattr(driven.planning._samples, "submit", lambda _: pytest.fail("another thread was woken"))
    for _ in range(3):
        driven.publish()
    wait_until(lambda: len(driven.done) == 3, what="three decisions")
    assert driven.decisions()["made"] == 3
    assert not driven.loop.waiting


def test_a_search_that_lasts_goes_on_beside_the_loop(drive, monkeypatch):
    """The loop goes on meanwhile, and the answer is the planner's."""
    monkeypatch.setattr("proxy.planning.TUNING", replace(TUNING, decided_at_once=-1.0))
    driven = drive('"sum"', 20.0)
    for _ in range(3):
        driven.publish()
    wait_until(lambda: len(driven.done) == 3, what="three decisions")
    assert (driven.decisions()["made"], driven.decisions()["late"]) == (3, 0)


def test_a_search_that_does_not_end_holds_nothing_up(drive):
    """Samples behind it are decided by the static rule, and what it says in the end is ignored."""
    driven = drive(SLOW, 0.05)
    Slow.may.clear()
    for _ in range(5):
        driven.publish()
    wait_until(lambda: len(driven.done) == 5, what="five decisions")
    decisions = driven.decisions()
    assert (decisions["made"], decisions["late"]) == (0, 5)
    assert driven.planning.stuck(clock.monotonic() + 60.0)
    assert driven.planning.warnings(clock.monotonic() + 60.0)[0].startswith("the planner hangs in a search")
    Slow.may.set()
    wait_until(lambda: not driven.planning.stuck(clock.monotonic() + 60.0), what="the end of the search")
    assert driven.decisions()["made"] == 0
    assert len(driven.done) == 5


def test_a_planner_that_is_mostly_late_is_told(drive):
    """Not where one is late at times. More come than fit on a slow machine, too: what fits needs no decision."""
    driven = drive(SLOW, 0.005)
    Slow.may.clear()

    def late():
        for _ in range(20):
            driven.publish()
        return driven.decisions()["late"]

    wait_until(lambda: late() > 0, what="a decision that is late")
    told = driven.planning.warnings(0.0)
    assert not told or driven.decisions()["late"] > RECENT / 2
    wait_until(lambda: late() >= RECENT, what="many of them")
    (warning,) = driven.planning.warnings(0.0)
    assert warning.startswith("most decisions take longer than planner.deadline, 5 ms, so samples")


def test_a_planner_whose_searches_are_mostly_cut_short_is_told(drive, monkeypatch):
    """It decides in time, but worse than it could."""
    monkeypatch.setattr("proxy.worker.TUNING", replace(TUNING, search_part=0.0))
    driven = drive('"sum"', 20.0)
    for _ in range(2):
        driven.publish()
    wait_until(lambda: len(driven.done) == 2, what="two decisions")
    assert driven.planning.warnings(clock.monotonic()) == []

    def told():
        for _ in range(20):  # more than fit, however slow the machine is: what fits needs no decision
            driven.publish()
        return driven.planning.warnings(clock.monotonic())

    wait_until(told, what="the warning")
    (warning,) = driven.planning.warnings(clock.monotonic())
    assert warning.startswith("most searches are cut short by planner.deadline, 20000 ms,")
