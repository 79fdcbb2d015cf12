"""Features are extracted in order; where only the latest sample counts, only of that."""

import threading
from contextlib import ExitStack
from dataclasses import replace

import pytest
import zenoh

from proxy import clock
from proxy import features as features_module
from proxy.core.interface.events import SamplePublished, SampleReread
from proxy.features import Extractor
from proxy.tuning import TUNING
from tests.waiting import wait_until


class Type:
    """An information type whose feature is the payload's number; `gate` holds it up. `quick`: it is known to be."""

    name = "test"
    features = ("n",)
    quick = False

    def extracts_within(self, _key, _most):
        return self.quick

    def __init__(self, *, needs_payload=True, markovian=True):
        self.needs_payload = needs_payload
        self.markovian = markovian
        self.gate = threading.Event()
        self.gate.set()
        self.begun = 0
        self.extracted = []
        self.attached = []

    def extract(self, key, payload, attachment, _background):
        self.begun += 1
        assert self.gate.wait(60.0)
        self.extracted.append((key, bytes(payload)))
        self.attached.append(attachment)
        return {"n": float(bytes(payload) or -1)}


class Costly(Type):
    """One that takes too long, and is computed in the background; the last value holds."""

    def extract(self, key, payload, attachment, background):
        if background.later(lambda: super(Costly, self).extract(key, payload, attachment, background)):
            return {"n": 0.5}
        return {"n": -0.5}


class Loop:
    """Keeps what is posted, and runs it when the test says so; what comes off a thread is run at once.

    `covering` is the type that covers all keys by the specs in force, if any does.
    """

    def __init__(self):
        self.due = []
        self.posted = []
        self.covering = None
        self._turn = threading.Lock()

    def post_at(self, when, job):
        self.due.append((when, job))
        if threading.current_thread().name == "features":
            self.run()

    def run(self):
        """Take up all that waits."""
        with self._turn:
            while self.due:
                self.posted.append(self.due.pop(0)[1]())


@pytest.fixture
def loop():
    return Loop()


@pytest.fixture
def extractor(loop):
    with ExitStack() as stack:
        made = Extractor(loop.post_at, lambda _: loop.covering)
        stack.callback(made.close, 1.0)
        yield made


def sample(number, key="k", *, now=0.0, delete=False):
    return SamplePublished(now, number, key, 1, 0.0, None, 5, {}, delete=delete)


def payload(number):
    return zenoh.ZBytes(str(number))


def told(loop):
    return [(event.sample, event.superseded, event.features) for event in loop.posted]


def test_features_come_with_the_sample_in_order(extractor, loop):
    """Each sample is posted with what was extracted from its payload."""
    covering = Type()
    for i in range(3):
        extractor.submit(sample(i, f"k{i}"), covering, payload(i))
    wait_until(lambda: len(loop.posted) == 3, what="three samples")
    assert told(loop) == [(i, 0, {"n": float(i)}) for i in range(3)]


def test_the_newest_takes_the_place_of_those_that_wait(extractor, loop):
    """While another key is extracted four samples arrive: one extraction, one event, which counts the other three."""
    slow = Type()
    slow.gate.clear()
    extractor.submit(sample(9, "slow"), slow, payload(9))
    covering = Type()
    gone = [extractor.submit(sample(i), covering, payload(i)) for i in range(4)]
    assert gone == [None, 0, 1, 2]
    slow.gate.set()
    wait_until(lambda: len(loop.posted) == 2, what="both keys")
    assert told(loop)[1] == (3, 3, {"n": 3.0})
    assert covering.extracted == [("k", b"3")]
    assert extractor.superseded == 3


def test_attachments_come_along(extractor, loop):
    """Each with its own sample, also where one takes the place of another."""
    covering, slow = Type(), Type()
    slow.gate.clear()
    extractor.submit(sample(9, "slow"), slow, payload(9))
    for i in range(2):
        extractor.submit(sample(i), covering, payload(i), zenoh.ZBytes(f"of {i}"))
    slow.gate.set()
    wait_until(lambda: len(loop.posted) == 2, what="both keys")
    assert [each.to_bytes() for each in covering.attached] == [b"of 1"]
    assert slow.attached == [None]


def test_what_takes_too_long_holds_up_no_stream(extractor, loop):
    """Not even its own: samples go on with the last value while the next one is computed."""
    costly, quick = Costly(), Type()
    costly.gate.clear()
    for i in range(TUNING.costly_jobs + 4):
        extractor.submit(sample(i, f"k{i}"), costly, payload(i))
    extractor.submit(sample(99, "quick"), quick, payload(99))
    wait_until(lambda: len(loop.posted) == TUNING.costly_jobs + 5, what="all samples")
    found = [features["n"] for _, _, features in told(loop)]
    assert found[: TUNING.costly_jobs] == [0.5] * TUNING.costly_jobs
    assert found[-2:] == [-0.5, 99.0]
    assert costly.extracted == []
    wait_until(lambda: costly.begun, what="the first one in the background")
    assert extractor.warnings(clock.monotonic() + 60.0)[0].startswith("a feature takes longer than 2 s")
    costly.gate.set()
    wait_until(lambda: len(costly.extracted) >= TUNING.costly_jobs, what="what waited in the background")


@pytest.mark.parametrize(("markovian", "each"), [(False, False), (True, True)], ids=["not markovian", "each asked for"])
def test_where_every_sample_counts_each_is_told_with_its_own_features(extractor, loop, markovian, each):
    """Nothing supersedes them, so a backlog costs what it costs."""
    covering = Type(markovian=markovian)
    covering.gate.clear()
    gone = [extractor.submit(sample(i), covering, payload(i), each=each) for i in range(4)]
    covering.gate.set()
    wait_until(lambda: len(loop.posted) == 4, what="four samples")
    assert gone == [None] * 4
    assert told(loop) == [(i, 0, {"n": float(i)}) for i in range(4)]


def test_what_needs_no_payload_does_not_wait(extractor, loop):
    """Types without such features overtake a slow extraction of others."""
    slow = Type()
    slow.gate.clear()
    extractor.submit(sample(1), slow, payload(1))
    extractor.submit(sample(2, "free"), Type(needs_payload=False), payload(2))
    loop.run()
    assert [event.sample for event in loop.posted] == [2]
    slow.gate.set()
    wait_until(lambda: len(loop.posted) == 2, what="the slow one")


@pytest.mark.parametrize("needs_payload", [True, False])
def test_a_delete_keeps_its_place(extractor, loop, needs_payload):
    """It waits behind the samples of its key, none of them superseded by one that came after it; it has no features."""
    covering = Type(needs_payload=needs_payload)
    covering.gate.clear()
    extractor.submit(sample(1), covering, payload(1))
    extractor.submit(sample(2, delete=True), covering, payload(2))
    assert extractor.submit(sample(3), covering, payload(3)) is None
    covering.gate.set()
    loop.run()
    wait_until(lambda: len(loop.posted) == 3, what="all three")
    assert [event.sample for event in loop.posted] == [1, 2, 3]
    assert loop.posted[1].features == {}


def test_one_stream_is_taken_up_no_faster_than_the_pace(extractor, loop):
    """The first at once, the next a pace later, with the newest in it; other keys do not wait for it."""
    covering = Type(needs_payload=False)
    extractor.submit(sample(1, now=1.0), covering, payload(1))
    loop.run()
    extractor.submit(sample(2, now=1.0001), covering, payload(2))
    extractor.submit(sample(3, "other", now=1.0002), covering, payload(3))
    assert [when for when, _ in loop.due] == [1.0 + TUNING.uptake_interval, 1.0002]
    assert extractor.submit(sample(4, now=1.001), covering, payload(4)) == 2
    loop.run()
    assert [(event.sample, event.superseded) for event in loop.posted] == [(1, 0), (4, 1), (3, 0)]


def test_remembered_keys_are_bounded(extractor, monkeypatch):
    """Many keys do not fill the memory."""
    monkeypatch.setattr(features_module, "TUNING", replace(TUNING, uptakes=2))
    for i in range(5):
        extractor.submit(sample(i, f"k{i}"), Type(needs_payload=False), payload(i))
    assert len(extractor._next) == 2


@pytest.mark.parametrize("needs_payload", [True, False])
def test_specs_that_change_meanwhile_count(extractor, loop, needs_payload):
    """The core never gets features of specs that are not in force any more."""
    before, after = Type(needs_payload=needs_payload), Type(needs_payload=needs_payload)
    before.gate.clear()
    extractor.submit(sample(1), before, payload(1))
    loop.covering = after
    before.gate.set()
    wait_until(lambda: loop.run() or loop.posted, what="the sample")
    assert told(loop) == [(1, 0, {"n": 1.0})]
    assert after.extracted == [("k", b"1")]


@pytest.mark.parametrize("needs_payload", [True, False])
def test_a_sample_is_read_again(extractor, loop, needs_payload):
    """By what is in force then, behind those before it; where nothing covers it any more without features."""
    loop.covering = Type(needs_payload=needs_payload)
    extractor.reread(SampleReread(0.0, 1, {}), "k", payload(7))
    wait_until(lambda: loop.run() or loop.posted, what="the sample")
    loop.covering = None
    extractor.reread(SampleReread(0.0, 2, {}), "k", payload(8))
    loop.run()
    assert loop.posted == [SampleReread(0.0, 1, {"n": 7.0}), SampleReread(0.0, 2, {})]


@pytest.fixture
def led(loop):
    """Samples that the core took in at once; while `open` it takes in all."""
    with ExitStack() as stack:
        taken = []
        taking = threading.Event()
        taking.set()

        def lead(event):
            if taking.is_set():
                taken.append(event.sample)
            return taking.is_set()

        made = Extractor(loop.post_at, lambda _: loop.covering, lead)
        stack.callback(made.close, 1.0)
        yield made, taken, taking


def test_what_has_no_features_goes_at_once_where_the_core_takes_it(led, loop):
    """The next ones of its key are not taken up faster in the long run, and wait behind one that waits."""
    extractor, taken, taking = led
    plain = Type(needs_payload=False)
    plain.features = ()
    ahead = int(TUNING.uptakes_ahead / TUNING.uptake_interval)
    for number in range(ahead + 2):
        extractor.submit(sample(number), plain, payload(number))
    extractor.submit(sample(8, now=TUNING.uptake_interval / 2), plain, payload(8))
    assert taken == [*range(ahead + 1)]
    assert [when for when, _ in loop.due] == [(ahead + 1) * TUNING.uptake_interval]
    loop.run()
    assert [event.sample for event in loop.posted] == [8]
    taking.clear()
    extractor.submit(sample(9, now=1.0), plain, payload(9))
    taking.set()
    extractor.submit(sample(10, now=1.1), plain, payload(10))
    loop.run()
    assert (taken[-1], loop.posted[-1].sample) == (ahead, 10)


def test_what_comes_after_a_delete_waits_behind_it(loop):
    """Though the core would take it at once: it does not know of the delete yet, which waits for its time."""
    led, kind = [], Type(needs_payload=False)
    kind.features = ()
    extractor = Extractor(loop.post_at, lambda _: kind, lambda event: not event.delete and not led.append(event.sample))
    for number in (1, 2, 3):
        extractor.submit(sample(number, delete=number == 2), kind, payload(number))
    assert led == [1]
    loop.run()
    extractor.submit(sample(4), kind, payload(4))
    assert ([event.sample for event in loop.posted], led) == ([2, 3], [1, 4])


def test_where_all_samples_of_a_key_go_none_gives_way_until_many_wait(loop):
    """Those of other keys give way as before, and so does what takes extraction."""
    with ExitStack() as stack:
        extractor = Extractor(loop.post_at, lambda _: loop.covering, goes=lambda key: key in "ac")
        stack.callback(extractor.close, 1.0)
        plain, slow = Type(needs_payload=False), Type()
        slow.gate.clear()
        gone = {"a": [], "b": [], "c": []}
        for number in range(TUNING.none_gives_way + 3):
            gone["a"].append(extractor.submit(sample(number, "a"), plain, payload(number)))
        for number in range(3):
            gone["b"].append(extractor.submit(sample(number, "b"), plain, payload(number)))
        extractor.submit(sample(9, "slow"), slow, payload(9))
        for number in range(3):
            gone["c"].append(extractor.submit(sample(number, "c"), slow, payload(number)))
        slow.gate.set()
    last = TUNING.none_gives_way
    assert gone["a"] == [None] * (last + 1) + [last, last + 1]
    assert gone["b"] == gone["c"] == [None, 0, 1]
    loop.run()
    assert [event.sample for event in loop.posted if event.key == "a"] == [*range(last), last + 2]


def test_who_extracts_features_brings_the_sample_to_the_core_where_nothing_waits(loop):
    """Where something does it is posted behind that."""
    brought, taking = [], threading.Event()
    taking.set()

    def bring(job):
        if taking.is_set():
            brought.append((job(), threading.current_thread().name))
        return taking.is_set()

    with ExitStack() as stack:
        extractor = Extractor(loop.post_at, lambda _: loop.covering, bring=bring)
        stack.callback(extractor.close, 1.0)
        covering = loop.covering = Type()
        extractor.submit(sample(1), covering, payload(1))
        wait_until(lambda: brought, what="the first sample")
        taking.clear()
        extractor.submit(sample(2), covering, payload(2))
        wait_until(lambda: loop.posted, what="the second one")
    assert [(event.sample, name) for event, name in brought] == [(1, "features")]
    assert [event.sample for event in loop.posted] == [2]


def submit_here(extractor, covering, *numbers, now=0.0, key="k"):
    for number in numbers:
        extractor.submit(sample(number, key, now=now), covering, payload(number))


def test_who_brings_a_sample_extracts_what_is_quick(loop):
    """Not a delete, nor what takes long, nor again before it had as much time for all else."""
    threads = []

    def bring(job):
        threads.append((job().sample, threading.current_thread() is threading.main_thread()))
        return True

    with ExitStack() as stack:
        extractor = Extractor(loop.post_at, lambda _: loop.covering, bring=bring)
        stack.callback(extractor.close, 1.0)
        covering = loop.covering = Type()
        covering.quick = True
        now = clock.monotonic()
        submit_here(extractor, covering, 1, now=now)
        submit_here(extractor, covering, 2, now=now)
        wait_until(lambda: len(threads) == 2, what="the second sample")
        submit_here(extractor, covering, 3, now=now + 60.0)
        extractor.submit(sample(4, now=now + 120.0, delete=True), covering, payload(4))
        wait_until(lambda: len(threads) == 4, what="the delete")
        covering.quick = False
        submit_here(extractor, covering, 5, now=now + 180.0)
        wait_until(lambda: len(threads) == 5, what="the one that takes long")
    assert threads == [(1, True), (2, False), (3, True), (4, False), (5, False)]


def test_none_overtakes_a_sample_that_is_being_extracted(loop):
    """Whoever extracts it; those that wait meanwhile are seen to when that is done."""
    with ExitStack() as stack:
        extractor = Extractor(loop.post_at, lambda _: loop.covering)
        stack.callback(extractor.close, 1.0)
        covering = loop.covering = Type(markovian=False)
        covering.quick = True
        covering.gate.clear()
        first = threading.Thread(target=submit_here, args=(extractor, covering, 1))
        first.start()
        wait_until(lambda: covering.begun, what="the first sample")
        submit_here(extractor, covering, 2, 3, now=60.0)
        assert not covering.extracted
        covering.gate.set()
        first.join()
        wait_until(lambda: loop.run() or len(loop.posted) == 3, what="the others")
    assert [number for _, number in covering.extracted] == [b"1", b"2", b"3"]


def test_what_has_features_is_extracted_first(led, loop):
    """It does not go at once, whatever the core would take."""
    extractor, taken, _ = led
    extractor.submit(sample(1), Type(needs_payload=False), payload(1))
    assert (taken, len(loop.due)) == ([], 1)
