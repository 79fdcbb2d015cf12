"""Of what came already a copy is left out."""

from dataclasses import replace

import pytest

from proxy.bridge import received
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.received import Received
from tests.proxy.nodes import closing, plain_session


@pytest.fixture
def stamp(stack):
    return closing(stack, plain_session("peer")).new_timestamp


@pytest.mark.parametrize("first", [True, False])
def test_a_copy_and_a_sample_with_one_timestamp_are_the_same(stamp, first):
    """Whichever comes first; on another key it is another sample."""
    heard, at = Received(), stamp()
    assert heard.takes("a", at, copy=first)
    assert not heard.takes("a", at, copy=not first)
    assert heard.takes("b", at, copy=not first)
    assert heard.takes("a", stamp(), copy=not first)


def test_only_copies_are_left_out_as_such(stamp):
    """An application may publish with one timestamp again and again; two copies are one."""
    heard, at, other = Received(), stamp(), stamp()
    assert [heard.takes("a", at, copy=False) for _ in range(3)] == [True] * 3
    assert [heard.takes("a", other, copy=True) for _ in range(3)] == [True, False, False]


def test_samples_without_timestamps_cannot_be_told_apart():
    """Those of nodes that run no Sendworthy: all are taken."""
    heard = Received()
    assert [heard.takes("a", None, copy=copy) for copy in (False, True, True)] == [True] * 3


def test_what_is_remembered_is_bounded(stamp, monkeypatch):
    """Of each key, and in keys: the oldest is forgotten."""
    monkeypatch.setattr(received, "BOUNDS", replace(BOUNDS, received_keys=2, received_samples=2))
    heard, stamps = Received(), [stamp() for _ in range(3)]
    for at in stamps:
        heard.takes("a", at, copy=False)
    assert [heard.takes("a", at, copy=True) for at in stamps[1:]] == [False, False]
    assert heard.takes("a", stamps[0], copy=True)
    for key in "bc":
        heard.takes(key, stamps[0], copy=False)
    assert heard.takes("a", stamps[2], copy=True)
