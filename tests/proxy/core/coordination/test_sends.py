"""Our own sends, and how long large samples take to leave."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.market.room import SendLog
from proxy.core.protocol.messages import State
from proxy.core.view.stream import Sent
from tests.proxy.core.coordination.conftest import BYTES, COUNT, ENERGY, heard
from tests.proxy.core.talk import SPEC


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


def test_many_late_sends_of_others_are_summed_up_once(make_budget):
    """Each of thousands that a digest tells is before the later ones of which one knows: else each sums up those."""
    budget, view = make_budget()
    for number in range(1000):
        heard(view, 2.0 - 0.001 * number, 1)
    assert budget._others.used(0.0, 0, budget.limits) == 1000.0
    assert budget._others._decided.changes <= 1


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


def test_under_a_limit_that_follows_the_channel_what_was_sent_stays_the_part_of_it_that_it_was(make_budget):
    """So there is room at once in a limit that was decreased, and none all at once in one that grew."""
    adaptive = replace(BYTES, least=0.05)
    budget, view = make_budget(adaptive)
    budget.use(1.0, (600.0,), 1)
    heard(view, 1.1, 200)
    assert budget.free(1.2) == pytest.approx([200.0])
    often = [(1.2 + 0.001 * n, 0.3 + 0.1 * (n % 7)) for n in range(100)]
    for now, part in (*often, (1.3, 0.5), (1.4, 1.0)):
        budget.set_limits((replace(adaptive, limit=part * adaptive.limit),), now)
        assert budget.used(now, 0) == pytest.approx(600.0 * part)
        assert budget.free(now) == pytest.approx([200.0 * part])
    budget.own.handed(1.5, 1)
    assert budget.used(2.4, 0) == pytest.approx(600.0)


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
            view.traffic.retract([view.traffic.note_unknown(now - 0.2, 500, "other")])
        if step == 20:
            budget.set_limits((COUNT, BYTES))
        for k, limit in enumerate(budget.limits):
            theirs = sum(use[k] for t, use in budget.others(now) if t >= now - limit.window)
            assert budget.free(now)[k] == pytest.approx(budget.whole(now, k) - theirs)
    assert budget.free(now + 10.0) == [budget.whole(now, k) for k in range(2)]


def load(view, now, size, robot="p0"):
    """A robot sends a sample of a stream that specs plan for."""
    stream = view.streams.touch(now, robot, f"robot/{robot}/camera")
    view.traffic.note_sent(stream, stream.forwarded + 1, Sent(now, now, size, 1.0))


@pytest.mark.parametrize("how", ["shadow", "pass", "type", "aside", "unplanned"])
def test_what_others_send_without_a_decision_leaves_the_floor(make_budget, make_specs, how):
    """In whatever mode a robot or a type is, or with other limits; what they decide on counts all."""
    text = SPEC.format(limit="8 kbit/s", window=1.0)
    if how == "type":
        text = text.replace('name = "camera"', 'name = "camera"\nmode = "shadow"')
    budget, view = make_budget(specs=make_specs(text=text))
    view.heard_state(0.5, State("p0", "p0", how if how in ("shadow", "pass") else "enforce", "", number=1))
    if how == "aside":
        view.members.set_aside(frozenset(("p0",)))
    for number in range(20):
        if how == "unplanned":
            view.traffic.note_unknown(1.0 + 0.05 * number, 200, "p0", planned=False)
        else:
            load(view, 1.0 + 0.05 * number, 200)
        assert budget.free(1.0 + 0.05 * number) == [1000.0 - min(900.0, 200.0 * (number + 1))]
    assert sum(use[0] for t, use in budget.others(2.0) if t > 1.0) == pytest.approx(900.0)
    assert budget.opens(1.99, (100.0,)) == -math.inf < budget.opens(1.99, (101.0,))
    view.members.set_aside(frozenset())
    view.heard_state(2.0, State("p0", "p0", "enforce", "", number=2))
    view.traffic.note_unknown(2.0, 1, "p0")
    assert budget.free(2.0) == [pytest.approx(99.0)]


def test_of_what_others_send_without_a_decision_the_newest_counts(make_budget):
    """What counts of a burst goes on to do so until it has left the window, whatever came before it."""
    budget, view = make_budget()
    for now in (1.0, 1.5):
        view.traffic.note_unknown(now, 900, "p0", planned=False)
    assert budget.free(1.6) == budget.free(2.4) == [100.0]
    assert [use for _, use in budget.others(1.6)] == [(0.0,), (900.0,)]
    assert budget.free(2.6) == [1000.0]


def test_what_nobody_decides_on_leaves_the_floor_whoever_sends_it(make_budget):
    """What we send so, and what others do, together; where each has its part only ours counts."""
    budget, view = make_budget()
    budget.use_at_most(1.0, (500.0,), 0.9)
    view.traffic.note_unknown(1.1, 5000, "p0", planned=False)
    assert budget.free(1.2) == [100.0]
    budget.use_at_most(1.2, (500.0,), 0.9)
    assert budget.free(1.3) == [100.0]
    assert budget.used(1.3, 0) == 500.0
    budget.set_limits((COUNT, BYTES))
    view.traffic.note_unknown(1.4, 1, "p0", planned=False)
    assert budget.free(1.4)[1] == 100.0
    split, _ = make_budget(kind="split")
    split.use_at_most(1.0, (5000.0,), 0.9)
    assert split.free(1.0) == pytest.approx([0.1 * split.whole(1.0, 0)])


def test_of_what_nobody_decided_on_the_newest_counts_in_whatever_order_it_is_told(make_budget):
    """Windows that end later hold no more of it than limits leave it."""
    for order in ((1.5, 2.0), (2.0, 1.5)):
        budget, view = make_budget()
        for now in order:
            view.traffic.note_unknown(now, 900, "p0", planned=False)
        assert {t: use for t, (use, *_) in budget.others(2.1)} == {1.5: 0.0, 2.0: 900.0}


def test_what_of_ours_nobody_decided_on_counts_at_once_for_what_theirs_may_take(make_budget):
    """Beside it theirs count for less, in the same moment, too."""
    budget, view = make_budget()
    view.traffic.note_unknown(1.0, 900, "p0", planned=False)
    assert budget.others(1.1) == ((1.0, (900.0,)),)
    budget.use_at_most(1.1, (100.0,), 1.0)
    taken = budget.used(1.1, 0)
    assert budget.others(1.1) == ((1.0, (900.0 - taken,)),)
