"""Features are extracted in order, off the caller's thread, and a backlog costs one extraction per key."""

import threading
from contextlib import ExitStack

import pytest
import zenoh

from proxy import features as features_module
from proxy.core.events import SamplePublished
from proxy.features import Extractor
from tests.waiting import wait_until


class Type:
    """An information type whose feature is the payload's number; `gate` holds it up."""

    name = "test"

    def __init__(self, *, needs_payload=True, markovian=True):
        self.needs_payload = needs_payload
        self.markovian = markovian
        self.gate = threading.Event()
        self.gate.set()
        self.extracted = []

    def extract(self, key, payload):
        assert self.gate.wait(5.0)
        self.extracted.append((key, bytes(payload)))
        return {"n": float(bytes(payload) or -1)}


@pytest.fixture
def posted():
    return []


@pytest.fixture
def extractor(posted):
    with ExitStack() as stack:
        made = Extractor(posted.append)
        made.start()
        stack.callback(made.close, 1.0)
        yield made


def sample(number, key="k", *, delete=False):
    return SamplePublished(0.0, number, key, 1, 0.0, None, 5, {}, delete=delete)


def payload(number):
    return zenoh.ZBytes(str(number))


def test_features_come_with_the_sample_in_order(extractor, posted):
    """Each sample is posted with what was extracted from its payload."""
    covering = Type()
    for i in range(3):
        extractor.submit(sample(i, f"k{i}"), covering, payload(i))
    wait_until(lambda: len(posted) == 3, what="three samples")
    assert [(event.sample, event.features) for event in posted] == [(i, {"n": float(i)}) for i in range(3)]


def test_a_backlog_costs_one_extraction_per_key(extractor, posted):
    """While the first is extracted three more of its key arrive: only the newest of them is extracted."""
    covering = Type()
    covering.gate.clear()
    for i in range(4):
        extractor.submit(sample(i), covering, payload(i))
    covering.gate.set()
    wait_until(lambda: len(posted) == 4, what="four samples")
    assert [event.sample for event in posted] == [0, 1, 2, 3]
    assert [event.features["n"] for event in posted] in ([0.0, 0.0, 0.0, 3.0], [3.0] * 4)
    assert extractor.skipped in (2, 3)
    assert covering.extracted[-1] == ("k", b"3")


def test_where_every_sample_counts_each_has_its_own_features(extractor, posted):
    """Nothing supersedes them, so a backlog costs what it costs."""
    covering = Type(markovian=False)
    covering.gate.clear()
    for i in range(4):
        extractor.submit(sample(i), covering, payload(i))
    covering.gate.set()
    wait_until(lambda: len(posted) == 4, what="four samples")
    assert [event.features["n"] for event in posted] == [0.0, 1.0, 2.0, 3.0]
    assert extractor.skipped == 0


def test_what_needs_no_payload_does_not_wait(extractor, posted):
    """Types without such features overtake a slow extraction of others; a delete waits behind its key's samples."""
    slow = Type()
    slow.gate.clear()
    extractor.submit(sample(1), slow, payload(1))
    extractor.submit(sample(2, "free"), Type(needs_payload=False), payload(2))
    extractor.submit(sample(3, delete=True), slow, payload(3))
    assert [(event.sample, event.features) for event in posted] == [(2, {"n": -1.0})]
    slow.gate.set()
    wait_until(lambda: len(posted) == 3, what="the slow ones")
    assert [event.sample for event in posted] == [2, 1, 3]
    assert posted[-1].features == {}


def test_remembered_features_are_bounded(extractor, posted, monkeypatch):
    """Many keys do not fill the memory."""
    monkeypatch.setattr(features_module, "_REMEMBERED", 2)
    covering = Type()
    for i in range(5):
        extractor.submit(sample(i, f"k{i}"), covering, payload(i))
    wait_until(lambda: len(posted) == 5, what="five samples")
    assert len(extractor._last) == 2
