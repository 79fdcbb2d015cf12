"""Slots: what robots hold for long goes where it gains most."""

import pytest

from proxy.core.slots import AWAITED, STAYS, Demand, allot, demands

ONE, OTHER = ("r1", "a"), ("r2", "b")


def test_slots_go_where_they_gain_most():
    """The second one of a stream gains less than the first one; each takes as much as it says."""
    wanted = [Demand(ONE, (1.0,), (9.0, 4.0, 1.0)), Demand(OTHER, (1.0,), (5.0, 3.0))]
    assert allot(wanted, (3.5,), {}) == {ONE: 2, OTHER: 1}
    assert allot(wanted, (9.0,), {}) == {ONE: 3, OTHER: 2}
    assert allot(wanted, (0.5,), {}) == {ONE: 0, OTHER: 0}


def test_what_a_slot_gains_counts_for_what_it_takes():
    """Of the constraint that it takes most of."""
    wanted = [Demand(ONE, (4.0, 0.0), (9.0,)), Demand(OTHER, (1.0, 1.0), (5.0,))]
    assert allot(wanted, (4.0, 8.0), {}) == {ONE: 0, OTHER: 1}


@pytest.mark.parametrize(("gain", "holder"), [(0.5 + 0.5 * STAYS, ONE), (1.05 * STAYS, OTHER)])
def test_who_has_a_slot_keeps_it_unless_another_one_gains_much_more(gain, holder):
    """Every move costs a window."""
    wanted = [Demand(ONE, (1.0,), (1.0,)), Demand(OTHER, (1.0,), (gain,))]
    counts = allot(wanted, (1.0,), {ONE: 1})
    assert counts[holder] == 1
    assert sum(counts.values()) == 1


def test_a_stream_that_sends_more_often_gains_by_every_slot_less(make_talk):
    """As many as let it send everything, and what nobody wants none."""
    talk = make_talk(settle=0.0)
    for number in range(6):
        talk.publish(0.1 + 0.4 * number)
    shared = tuple(limit for limit in talk.core.gate.limits if limit.shared)
    assert demands(3.0, talk.core.view, shared, talk.core.gate.cadences) == []
    talk.want(2.9)
    (demand,) = demands(3.0, talk.core.view, shared, talk.core.gate.cadences)
    assert list(demand.gains) == sorted(demand.gains, reverse=True)
    assert min(demand.gains) > 0.0
    assert len(demand.gains) == int(max(limit.window for limit in shared) / 0.4) + 1


def gains_with_period(talk, part):
    """What a stream gains that has its period in a window so often."""
    shared = tuple(limit for limit in talk.core.gate.limits if limit.shared)
    window = max(limit.window for limit in shared)
    for number in range(6):
        talk.publish(0.1 + part * window * number)
    talk.want(6.0 * part * window)
    (demand,) = demands(6.0 * part * window + 0.1, talk.core.view, shared, talk.core.gate.cadences)
    return demand.gains


@pytest.mark.parametrize("off", [-0.005, 0.005])
def test_a_stream_that_fits_evenly_gains_alike_when_its_period_is_a_little_off(make_talk, off):
    """Else slots would move whenever somebody measures it anew."""
    gains, evenly = gains_with_period(make_talk(settle=0.0), 0.5 + off), gains_with_period(make_talk(settle=0.0), 0.5)
    assert len(evenly) == 2
    assert sum(gains[:2]) == pytest.approx(sum(evenly), rel=0.1)
    assert gains[0] == pytest.approx(evenly[0], rel=0.1)


def test_a_stream_of_which_nobody_knows_how_often_it_sends_has_no_slot_yet(make_talk):
    """One sample tells nothing: who leads would take it for a fast stream. Room for one is kept, but not for ever."""
    talk = make_talk(settle=0.0)
    talk.publish(0.1)
    talk.want(0.2)
    shared = tuple(limit for limit in talk.core.gate.limits if limit.shared)
    (demand,) = demands(0.3, talk.core.view, shared, talk.core.gate.cadences)
    assert not demand.known
    assert len(demand.gains) == 1
    assert demand.gains[0] > 0.0
    assert allot([demand], [1e9], {}) == {demand.place: 1}
    assert demands(0.2 + AWAITED, talk.core.view, shared, talk.core.gate.cadences) == []
