"""Receivers in groups of equal latency."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Receiver
from proxy.core.view.receivers import Way, grouped
from proxy.core.view.tuning import TUNING


def test_equal_latencies_are_one_group():
    """To the millisecond; who hears first has no delay."""
    assert grouped([Way(0.02)]) == (0.02, (Receiver(0.0, 1.0),))
    latency, receivers = grouped([Way(0.0201), Way(0.1), Way(0.0199)])
    assert latency == pytest.approx(0.02)
    assert receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))


def test_a_robot_counts_as_far_as_messages_get_to_it():
    """So does its latency within its group; where nothing gets, all count alike."""
    latency, receivers = grouped([Way(0.02, 0.75), Way(0.0204, 0.25)])
    assert latency == pytest.approx(0.0201)
    assert receivers == (Receiver(0.0, 1.0),)
    assert grouped([Way(0.01, 0.0), Way(0.0102, 0.0)]) == (pytest.approx(0.0101), (Receiver(0.0, 0.0),))


def test_too_many_groups_are_joined_where_they_are_closest():
    """At the mean of their robots."""
    latency, receivers = grouped(map(Way, [0.01, 0.02, 0.022, 0.0222, 0.1, 0.2]))
    assert latency == 0.01
    assert [r.share for r in receivers] == [1.0, 3.0, 1.0, 1.0]
    assert [r.delay for r in receivers] == pytest.approx([0.0, 0.0114, 0.09, 0.19])


@given(st.lists(st.tuples(st.floats(0.0, 5.0), st.floats(0.05, 1.0)), min_size=1, max_size=30))
def test_every_robot_counts_once_and_the_mean_latency_stays(drawn):
    """However they are grouped."""
    latency, receivers = grouped(Way(*way) for way in drawn)
    assert 1 <= len(receivers) <= TUNING.receiver_groups
    assert min(r.delay for r in receivers) == 0.0
    share = sum(share for _, share in drawn)
    assert sum(r.share for r in receivers) == pytest.approx(share)
    mean = latency + sum(r.delay * r.share for r in receivers) / share
    assert mean == pytest.approx(sum(took * part for took, part in drawn) / share)
