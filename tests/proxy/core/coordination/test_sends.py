"""Our own sends, and how long large samples take to leave."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.market.room import SendLog
from tests.proxy.core.coordination.conftest import BYTES, COUNT, ENERGY, heard


def test_a_large_sample_counts_from_when_the_mesh_took_it(make_budget):
    """A small one may as well count from its decision; one that was refused stays where it was."""
    budget, _ = make_budget()
    for now, size, sample in ((1.0, 600.0, 1), (1.001, 2.0, 2), (1.002, 300.0, 3)):
        budget.use(now, (size,), sample)
    budget.own.refused(3)
    for sample in (1, 2, 3, 4, 1):
        budget.own.handed(1.005 + 0.001 * sample, sample)
    assert budget.used(2.0, 0) == 902.0
    assert budget.used(2.0015, 0) == 900.0
    assert budget.used(2.003, 0) == 600.0
    assert budget.opens(1.5, (500.0,)) == pytest.approx(2.006, abs=1e-5)


def test_samples_of_others_are_taken_to_leave_as_late_as_ours(make_budget):
    """At least as late as the last one did, and not later than now; where ours leave at once theirs do."""
    budget, view = make_budget()
    heard(view, 1.0, 600)
    assert budget.others(1.1) == ((1.0, (600.0,)),)
    budget.use(1.1, (200.0,), 1)
    budget.own.handed(1.105, 1)
    assert budget.others(1.2) == ((pytest.approx(1.005), (600.0,)),)
    budget.use(1.3, (200.0,), 2)
    budget.own.handed(1.3, 2)
    assert budget.others(1.4) == ((pytest.approx(1.0045), (600.0,)),)
    budget.use(1.5, (200.0,), 3)
    budget.own.handed(1.9, 3)
    heard(view, 1.95, 100)
    assert budget.others(1.96) == ((pytest.approx(1.02), (600.0,)), (1.96, (100.0,)))


def test_a_sample_that_leaves_under_other_limits_counts_under_these(make_budget):
    """From its decision."""
    budget, _ = make_budget()
    budget.use(1.0, (600.0,), 1)
    budget.set_limits((COUNT, BYTES))
    budget.own.handed(1.4, 1)
    assert budget.used(2.0, 1) == 600.0
    assert budget.used(2.1, 1) == 0.0


def test_under_new_limits_what_was_sent_counts_against_those_of_the_same_name_and_kind(make_budget):
    """In whatever order; of a new one nothing was used."""
    budget, _ = make_budget(BYTES, COUNT)
    budget.use(1.0, (300.0, 1.0))
    budget.set_limits((COUNT, replace(BYTES, limit=2000.0), ENERGY))
    assert [budget.used(1.1, k) for k in range(3)] == [1.0, 300.0, 0.0]
    assert budget.free(1.1) == [3.0, 1700.0, 3.0]
    budget.set_limits((replace(COUNT, name="bytes"),))
    assert budget.used(1.1, 0) == 0.0


@given(
    st.lists(
        st.tuples(st.sampled_from(("add", "add", "remove", "forget")), st.integers(-8, 3), st.integers(0, 50)),
        max_size=60,
    )
)
def test_a_log_of_sends_knows_what_was_used_since_any_moment(acts):
    """As adding it all up says, whatever came late, was taken back or forgotten."""
    log, sends, now = SendLog(), [], 0.0
    for act, ago, amount in acts:
        now += 1.0
        if act == "add":
            sends.append((now + ago, (float(amount), 1.0)))
            log.add(*sends[-1])
        elif act == "remove" and sends:
            assert log.remove(sends.pop(amount % len(sends)))
            assert not log.remove((now, (-1.0, -1.0)))
        elif act == "forget":
            sends = [send for send in sends if send[0] >= now + ago - 20.0]
            log.forget(now + ago - 20.0)
        assert sorted(log) == sorted(sends)
        assert [t for t, _ in log] == sorted(t for t, _ in sends)
        for since in (now - 30.0, now - 4.0, now):
            for k in (0, 1):
                assert log.used(since, k) == sum(use[k] for t, use in sends if t >= since)


def test_what_is_counted_of_others_is_what_they_sent(make_budget):
    """Under these limits and under others, in a window and in none, though some of it turns out to be none."""
    budget, view = make_budget(BYTES, COUNT)
    for step in range(40):
        now = 1.0 + 0.1 * step
        heard(view, now, 10 + step)
        if step % 11 == 0:
            view.traffic.retract(view.traffic.note_unknown(now - 0.2, 500, "other"))
        if step == 20:
            budget.set_limits((COUNT, BYTES))
        for k, limit in enumerate(budget.limits):
            theirs = sum(use[k] for t, use in budget.others(now) if t >= now - limit.window)
            assert budget.free(now)[k] == pytest.approx(budget.whole(now, k) - theirs)
    assert budget.free(now + 10.0) == [budget.whole(now, k) for k in range(2)]
