"""Samples wait for their decision, are kept for copies, or both; their payloads have one home."""

import pytest

from proxy.bridge.payloads import Payloads
from proxy.bridge.room import Room
from proxy.bridge.sample import Held


@pytest.fixture
def room():
    return Room(2, 100)


@pytest.fixture
def payloads(room):
    return Payloads(room)


def held(size=10):
    return Held(None, None, "a", size, None)


def test_a_sample_waits_until_it_is_dropped_and_has_a_place_as_long(payloads, room):
    """Numbers are never given again; who drops one twice gives back one place."""
    first, second = held(), held()
    assert [payloads.enter(first), payloads.enter(second), payloads.enter(held())] == [1, 2, None]
    assert (len(payloads), room.samples, payloads.waiting(2)) == (2, 2, second)
    for _ in range(2):
        payloads.drop(2)
    assert (len(payloads), room.samples, payloads.waiting(2)) == (1, 1, None)
    assert payloads.enter(held()) == 3


def test_what_is_released_keeps_its_place(payloads, room):
    """Until it is sent, which others see to; it waits for no decision any more."""
    sample = held()
    number = payloads.enter(sample)
    assert payloads.release(number) is sample
    assert payloads.release(number) is payloads.waiting(number) is None
    payloads.drop(number)
    assert room.samples == 1


def test_what_is_kept_stays_whatever_becomes_of_the_sample(payloads):
    """A copy is addressed to one robot; what was forgotten, or never waited, has none."""
    sample = held()
    number = payloads.enter(sample)
    payloads.keep(number)
    payloads.drop(number)
    payloads.keep(number + 1)
    assert payloads.copy(number, "ab12") == sample._replace(to="ab12")
    assert payloads.copy(number + 1, "ab12") is None
    payloads.forget(number)
    payloads.forget(number)
    assert payloads.copy(number, "ab12") is None
