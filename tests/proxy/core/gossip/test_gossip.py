"""Whom to ask for a state."""

from itertools import pairwise

import pytest

from proxy.core.gossip.gossip import StateRequests
from proxy.core.gossip.tuning import TUNING

FIRST = TUNING.first_answer
APART = TUNING.questions_apart


def test_each_is_asked_in_turn_and_again_more_and_more_slowly():
    """A question may be lost, and so may its answer."""
    requests, asked, now = StateRequests(0.0), [], 0.0
    assert requests.take(0.0) is None
    assert requests.due_at == float("inf")
    for tag in ("b", "a"):
        requests.want(0.0, tag)
    requests.want(0.3, "a")
    while now < 200.0:
        if (tag := requests.take(now)) is not None:
            asked.append((round(now, 3), tag))
        now = max(now, requests.due_at)
    assert asked[:4] == [
        (0.0, "a"),
        (APART, "b"),
        (FIRST, "a"),
        (APART + FIRST, "b"),
    ]
    times = [now for now, tag in asked if tag == "a"]
    assert max(after - before for before, after in pairwise(times)) == TUNING.longest_wait
    assert requests.asked == len(asked)


def test_who_has_answered_is_asked_no_more():
    """Nor who has left."""
    requests = StateRequests(0.0)
    requests.want(0.0, "a")
    requests.done("a")
    requests.done("b")
    assert requests.take(1.0) is None


def test_of_many_a_few_are_asked_at_once_and_the_others_in_time():
    """What questions take is spread, as it is for all who ask."""
    requests, asked, now = StateRequests(0.0), [], 0.0
    for tag in range(20):
        requests.want(0.0, f"{tag:02d}")
    while len(asked) < 20:
        if (tag := requests.take(now, 1.5)) is not None:
            asked.append(now)
            requests.done(tag)
        now += 0.01
    assert asked[TUNING.questions_at_once - 1] < 1.0
    assert asked[-1] == pytest.approx(1.5 * (20 - TUNING.questions_at_once), rel=0.1)
