"""Samples that must not overtake what was declared before them."""

import threading
import types
from collections.abc import Callable
from dataclasses import replace

import pytest
import zenoh

from proxy import clock
from proxy.bridge import barrier as barrier_module
from proxy.bridge import bounds
from proxy.bridge.barrier import Barrier
from proxy.bridge.fence import Fence
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING
from tests.proxy.bridge import robots
from tests.proxy.bridge.robots import fence_apps, observes, wait_interest
from tests.proxy.nodes import Heard, answers
from tests.waiting import wait_until

PATIENCE = 60.0
"""So long an application waits that would wait for ever [s]."""


class WaitsError(Exception):
    """Somebody would wait."""


class Turn(threading.Condition):
    """Whoever waits has done meanwhile what the test says."""

    def __init__(self):
        super().__init__(threading.Lock())

    def meanwhile(self):
        raise WaitsError

    def wait(self, timeout=None):
        assert timeout is not None
        self.release()
        try:
            self.meanwhile()
        finally:
            self.acquire()
        return True


class Side:
    """A side, and an executor, whose jobs are done when the test says so."""

    def __init__(self):
        self.jobs: list[Callable[[], object]] = []
        self.after_told = self.after_taken = self.insist = self.jobs.append

    def do(self):
        """Do what waits now, as far as that need not wait for anything."""
        while self.jobs:
            try:
                self.jobs[0]()
            except WaitsError:
                return
            del self.jobs[0]


class Bench:
    """A barrier between two sides, whose samples leave a mark when they go."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr(barrier_module, "clock", types.SimpleNamespace(monotonic=lambda: self.now))
        self.near, self.far, self.executor = Side(), Side(), Side()
        self.fence = Fence(lambda: None)
        self.barrier = Barrier(self.near, self.far, self.fence, self.executor)
        self.turn = self.barrier._turn = Turn()
        self.went: list[str] = []

    def comes(self, now, key, *, ordered=True, size=1, mark="", job=lambda: None):
        """A sample comes; whether it goes at once."""
        self.now = now
        quiet = self.barrier.holds(key, now, ordered=ordered)
        if quiet is None:
            self.went.append(mark or key)
            return True

        def goes():
            job()
            self.went.append(mark or key)

        self.barrier.hold(key, now, size, goes, quiet=quiet)
        return False

    def look(self):
        """Mirror what is declared."""
        self.fence.begin()
        self.fence.end()

    def end(self):
        """Bring the round that is under way to its end."""
        self.near.do()
        self.look()
        self.far.do()

    def round(self):
        """The same, and do what waited for it."""
        self.end()
        self.executor.do()


@pytest.fixture
def bench(monkeypatch):
    """Streams have come for a while."""
    made = Bench(monkeypatch)
    for key in ("stream", "covered"):
        made.comes(0.0, key)
        made.round()
    made.went.clear()
    return made


def test_a_sample_of_a_quiet_key_waits_until_all_that_was_declared_before_is_mirrored(bench):
    """Told, mirrored, and taken in: each of these comes after the one before."""
    assert not bench.comes(0.1, "start")
    for step in (bench.near.do, bench.look, bench.far.do):
        bench.executor.do()
        assert bench.went == []
        step()
    bench.executor.do()
    assert bench.went == ["start"]
    assert bench.comes(0.2, "start")


def test_what_comes_behind_it_waits_with_it_but_for_what_goes_in_no_order(bench):
    """Covered streams are not held up, and samples of one key stay in order."""
    assert not bench.comes(0.1, "start")
    assert not bench.comes(0.1, "stream")
    assert bench.comes(0.1, "covered", ordered=False)
    assert not bench.comes(0.1, "start", ordered=False)
    bench.end()
    assert not bench.comes(0.1, "stream"), "those before it are about to go"
    bench.executor.do()
    assert bench.went == ["covered", "start", "stream", "start", "stream"]
    assert bench.comes(0.2, "stream")


def test_each_sample_of_a_quiet_key_has_a_round_that_began_after_it_came(bench):
    """What was declared between two may not be in the round of the first."""
    bench.comes(0.1, "start")
    bench.near.do()
    bench.comes(0.1, "other")
    bench.look()
    bench.far.do()
    bench.executor.do()
    assert bench.went == ["start"]
    bench.round()
    assert bench.went == ["start", "other"]


def test_a_round_that_takes_too_long_holds_nothing_any_more(bench):
    """Nor is anything held for a while; what comes of that round later changes nothing."""
    bench.comes(0.1, "start")
    bench.comes(0.1, "stream")
    bench.executor.do()
    assert bench.went == []
    bench.now = end = 0.1 + TUNING.barrier_wait
    bench.executor.do()
    assert bench.went == ["start", "stream"]
    assert bench.comes(end, "other")
    bench.round()
    later = end + TUNING.barrier_rest
    assert not bench.comes(later, "third")
    bench.round()
    assert bench.went == ["start", "stream", "other", "third"]


def test_where_no_round_comes_to_its_end_samples_are_held_ever_more_seldom(bench):
    """Access control may not let markers pass. One that does come to its end makes up for all that did not."""
    now = 0.1
    for number in range(10):
        assert not bench.comes(now, f"key/{number}")
        bench.now = now = now + TUNING.barrier_wait
        bench.executor.do()
        rest = min(TUNING.barrier_rest * 2.0**number, TUNING.longest_barrier_rest)
        assert bench.comes(now + 0.99 * rest, f"late/{number}")
        now += rest
    bench.round()
    bench.comes(now, "key")
    bench.now = now = now + TUNING.barrier_wait
    bench.executor.do()
    assert not bench.comes(now + TUNING.barrier_rest, "another")


def test_a_round_that_takes_too_long_is_given_up_though_nobody_mirrors():
    """Who declares much has whoever mirrors busy for a second and more: that is no reason for a sample to wait."""
    executor, went = SerialExecutor("test"), threading.Event()
    barrier = Barrier(Side(), Side(), Fence(lambda: None), executor)
    quiet = barrier.holds("start", clock.monotonic(), ordered=True)
    barrier.hold("start", clock.monotonic(), 1, went.set, quiet=quiet)
    assert went.wait(60.0)
    executor.close(60.0)


@pytest.mark.parametrize(("field", "size"), [("held_samples", 1), ("held_bytes", 1000)])
def test_no_more_is_held_than_there_is_room_for(bench, monkeypatch, field, size):
    """The rest goes at once; whoever brings more of a key that is held does first what is held of it."""
    monkeypatch.setattr(barrier_module, "BOUNDS", replace(bounds.BOUNDS, **{field: 4 * size}))
    keys = ["key/0", "key/1", "key/0", "key/2"]
    assert [bench.comes(0.1, key, size=size, mark=f"{key} {n}") for n, key in enumerate(keys)] == [False] * 4
    assert bench.comes(0.1, "key/3", size=size)
    assert bench.comes(0.1, "key/0", size=size, mark="key/0 5")
    assert bench.went == ["key/3", "key/0 0", "key/0 2", "key/0 5"]
    bench.round()
    bench.round()
    assert bench.went[4:] == ["key/1 1", "key/2 3"]
    assert not bench.comes(0.2, "key/6")


def test_behind_a_sample_that_nobody_takes_nothing_is_held(bench):
    """An application hangs: whoever brings samples is held up by it himself, as without a barrier.

    What goes to others does not wait for it, and stays in order.
    """

    def hang():
        assert not bench.comes(0.1 + TUNING.barrier_wait, "stream", mark="stream 1")
        assert bench.comes(0.1 + 1.01 * TUNING.barrier_wait, "another")
        assert bench.comes(0.1 + 1.01 * TUNING.barrier_wait, "stream", mark="stream 2")
        with pytest.raises(WaitsError):
            bench.comes(0.1 + 1.01 * TUNING.barrier_wait, "start")

    bench.comes(0.1, "start", job=hang)
    bench.comes(0.1, "stream", mark="stream 0")
    bench.round()
    assert bench.went == ["another", "stream 0", "stream 1", "stream 2", "start"]
    assert not bench.barrier._keys


def test_who_comes_behind_a_sample_waits_until_it_went(bench):
    """What came before it, too; what is held later is not waited for."""
    assert bench.barrier.newest == 0
    bench.barrier.await_gone(0)
    bench.comes(0.1, "start")
    bench.comes(0.1, "stream")
    behind = bench.barrier.newest
    bench.comes(0.1, "later")
    with pytest.raises(WaitsError):
        bench.barrier.await_gone(behind)
    waits = bench.turn.meanwhile

    def meanwhile():
        bench.turn.meanwhile = waits
        bench.round()

    bench.turn.meanwhile = meanwhile
    bench.barrier.await_gone(behind)
    assert bench.went == ["start", "stream"]
    bench.round()
    assert bench.went == ["start", "stream", "later"]
    assert bench.barrier.newest == 0


def test_nobody_waits_for_longer_than_a_round_may_take(bench):
    """Nor at all where an application hangs that takes a sample."""

    def hang():
        bench.turn.meanwhile = lambda: setattr(bench, "now", bench.now + TUNING.barrier_wait)
        bench.barrier.await_gone(bench.barrier.newest)
        assert bench.now == 0.1 + TUNING.barrier_wait, "it waited once"
        bench.now += 0.01
        bench.barrier.await_gone(bench.barrier.newest)
        assert bench.now == 0.11 + TUNING.barrier_wait, "it did not"

    bench.comes(0.1, "start", job=hang)
    bench.round()
    assert bench.went == ["start"]


def test_a_barrier_that_is_closed_holds_nothing(bench):
    """And what it held goes, what was about to go included, for nothing is mirrored any more."""
    bench.comes(0.1, "start")
    bench.end()
    bench.comes(0.1, "other")
    bench.turn.meanwhile = bench.executor.do
    bench.barrier.close(60.0)
    assert bench.went == ["start", "other"]
    assert bench.comes(9.0, "later")


def test_a_sample_that_cannot_go_holds_nothing_up(bench, caplog):
    """Its place is free again, and what is behind it goes; the log says what is lost."""
    bench.comes(0.1, "start", job=lambda: 1 / 0)
    bench.comes(0.1, "stream")
    bench.round()
    assert bench.went == ["stream"]
    assert "a sample on start that was held is lost" in caplog.text
    assert bench.comes(0.2, "stream")


def test_no_more_keys_are_remembered_than_there_is_room_for(bench, monkeypatch):
    """Of those that are forgotten it is not known whether they were quiet: streams among them are not held up."""
    monkeypatch.setattr(barrier_module, "BOUNDS", replace(bounds.BOUNDS, keys=2))
    assert not bench.comes(0.1, "start")
    bench.round()
    assert bench.comes(0.2, "stream")
    assert len(bench.barrier._came) == 1
    assert bench.comes(0.2, "key/5")
    assert not bench.comes(0.2 + TUNING.quiet_key, "key/6")


@pytest.fixture
def pair(stack, tmp_path, monkeypatch):
    """Two robots on which no round is given up, however busy the machine is."""
    monkeypatch.setattr(barrier_module, "TUNING", replace(TUNING, barrier_wait=PATIENCE))
    return robots.team(stack, tmp_path, size=2)


ROUNDS = 20


def test_who_subscribes_and_then_asks_for_a_sample_gets_it(pair):
    """The sample that asks for it does not overtake the subscription on its way to whoever answers."""
    here, there = pair[1].node(), pair[0].node()
    answers = zenoh.handlers.Callback(lambda sample: there.put(str(sample.payload), "x"), indirect=False)
    asked = there.declare_subscriber("ask/**", answers)
    wait_interest(pair[0], pair[1], keys=("ask/**",))
    for number in range(ROUNDS):
        heard = Heard(here, f"answer/{number}")
        here.put(f"ask/{number}", f"answer/{number}")
        wait_until(lambda heard=heard: heard.samples, what=f"answer {number}")
        heard.subscriber.undeclare()
    asked.undeclare()


@pytest.mark.parametrize("kind", ["queryable", "token"])
def test_who_hears_that_something_is_there_finds_it(pair, kind):
    """A service, or a token, of which its own robot says in a sample that it is there."""
    here, there = pair[1].node(), pair[0].node()
    found: list[bool] = []
    asked = threading.Semaphore(0)

    def seek(number: str) -> None:
        session = here.liveliness() if kind == "token" else here
        found.append(any(reply.ok for reply in session.get(f"thing/{number}", timeout=PATIENCE)))
        asked.release()

    def hear(sample: zenoh.Sample) -> None:
        threading.Thread(target=seek, args=(sample.payload.to_string(),)).start()

    subscriber = here.declare_subscriber("ready/**", zenoh.handlers.Callback(hear, indirect=False))
    wait_until(lambda: observes(pair[0], "ready/**"), what="whoever wants to know")
    for number in range(ROUNDS):
        thing = _declared(there, kind, f"thing/{number}")
        there.put(f"ready/{number}", f"{number}")
        assert asked.acquire(timeout=PATIENCE)
        thing.undeclare()
    subscriber.undeclare()
    assert found == [True] * ROUNDS


def test_who_stores_something_and_asks_for_it_gets_it(pair):
    """A query does not overtake what its application published before, on keys that were quiet."""
    here, there = pair[0].node(), pair[1].node()
    stored: dict[str, str] = {}

    def answer(query: zenoh.Query) -> None:
        with query:
            key = str(query.key_expr)
            query.reply(key, stored.get(key, "nothing"))

    take = zenoh.handlers.Callback(lambda sample: stored.update({str(sample.key_expr): "it"}), indirect=False)
    served = there.declare_queryable("store/*", zenoh.handlers.Callback(answer, indirect=False))
    storage = there.declare_subscriber("store/*", take)
    wait_interest(pair[1], pair[0], keys=("store/*",))
    wait_until(lambda: "store/*" in pair[0].bridge._outward.expressions, what="the storage")
    fence_apps(pair[0])
    found = []
    for number in range(5 * ROUNDS):
        here.put(f"store/{number}", "it")
        found += list(answers(here, f"store/{number}"))
    assert found == ["it"] * 5 * ROUNDS
    served.undeclare()
    storage.undeclare()


def test_what_is_published_before_an_answer_comes_before_it(pair):
    """A reply, an error, and the end of a query that nobody answers."""
    here, there = pair[1].node(), pair[0].node()
    heard: list[str] = []

    def answer(query: zenoh.Query) -> None:
        with query:
            kind, number = str(query.parameters).split(":")
            there.put(f"done/{kind}/{number}", "done")
            if kind == "reply":
                query.reply("do/it", "yes")
            elif kind == "error":
                query.reply_err("no")

    take = zenoh.handlers.Callback(lambda sample: heard.append(str(sample.key_expr)), indirect=False)
    served = there.declare_queryable("do/it", zenoh.handlers.Callback(answer, indirect=False))
    listener = here.declare_subscriber("done/**", take)
    wait_interest(pair[1], pair[0], keys=("done/**",))
    wait_until(lambda: "do/it" in pair[1].bridge._outward.expressions, what="the service")
    fence_apps(pair[1])
    late = []
    for number in range(ROUNDS):
        for kind, told in (("reply", ["yes"]), ("error", ["error: no"]), ("nothing", [])):
            assert list(answers(here, f"do/it?{kind}:{number}")) == told
            late += [f"{kind} {number}"] * (f"done/{kind}/{number}" not in heard)
    assert late == []
    served.undeclare()
    listener.undeclare()


def _declared(session, kind, key):
    if kind == "token":
        return session.liveliness().declare_token(key)

    def answer(query):
        with query:
            query.reply(key, "here")

    return session.declare_queryable(key, zenoh.handlers.Callback(answer, indirect=False))
