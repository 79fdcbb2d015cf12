"""Receivers in groups of equal latency."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Receiver
from proxy.core.receivers import MOST_GROUPS, grouped


def test_equal_latencies_are_one_group():
    """To the millisecond; who hears first has no delay."""
    assert grouped([0.02]) == (0.02, (Receiver(0.0, 1.0),))
    latency, receivers = grouped([0.0201, 0.1, 0.0199])
    assert latency == pytest.approx(0.02)
    assert receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))


def test_too_many_groups_are_joined_where_they_are_closest():
    """At the mean of their robots."""
    latency, receivers = grouped([0.01, 0.02, 0.022, 0.0222, 0.1, 0.2])
    assert latency == 0.01
    assert [r.share for r in receivers] == [1.0, 3.0, 1.0, 1.0]
    assert [r.delay for r in receivers] == pytest.approx([0.0, 0.0114, 0.09, 0.19])


@given(st.lists(st.floats(0.0, 5.0), min_size=1, max_size=30))
def test_every_robot_counts_once_and_the_mean_latency_stays(latencies):
    """However they are grouped."""
    latency, receivers = grouped(latencies)
    assert 1 <= len(receivers) <= MOST_GROUPS
    assert min(r.delay for r in receivers) == 0.0
    assert sum(r.share for r in receivers) == len(latencies)
    mean = latency + sum(r.delay * r.share for r in receivers) / len(latencies)
    assert mean == pytest.approx(sum(latencies) / len(latencies))
