"""Whom to ask for a state."""

from itertools import pairwise

import pytest

from proxy.core.gossip.state_requests import AT_ONCE, FIRST, LONGEST, PACE, Asking


def test_each_is_asked_in_turn_and_again_more_and_more_slowly():
    """A question may be lost, and so may its answer."""
    asking, asked, now = Asking(0.0), [], 0.0
    assert asking.due(0.0) is None
    assert asking.next_at() == float("inf")
    for tag in ("b", "a"):
        asking.want(0.0, tag)
    asking.want(0.3, "a")
    while now < 200.0:
        if (tag := asking.due(now)) is not None:
            asked.append((round(now, 3), tag))
        now = max(now, asking.next_at())
    assert asked[:4] == [(0.0, "a"), (PACE, "b"), (FIRST, "a"), (PACE + FIRST, "b")]
    times = [now for now, tag in asked if tag == "a"]
    assert max(after - before for before, after in pairwise(times)) == LONGEST
    assert asking.asked == len(asked)


def test_who_has_answered_is_asked_no_more():
    """Nor who has left."""
    asking = Asking(0.0)
    asking.want(0.0, "a")
    asking.done("a")
    asking.done("b")
    assert asking.due(1.0) is None


def test_of_many_a_few_are_asked_at_once_and_the_others_in_time():
    """What questions take is spread, as it is for all who ask."""
    asking, asked, now = Asking(0.0), [], 0.0
    for tag in range(20):
        asking.want(0.0, f"{tag:02d}")
    while len(asked) < 20:
        if (tag := asking.due(now, 1.5)) is not None:
            asked.append(now)
            asking.done(tag)
        now += 0.01
    assert asked[AT_ONCE - 1] < 1.0
    assert asked[-1] == pytest.approx(1.5 * (20 - AT_ONCE), rel=0.1)
