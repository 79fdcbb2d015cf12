"""Epochs: one robot at a time leads, and nobody who sent under another one follows too soon."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.measures import Throughput
from proxy.core.epochs import EDGE, LONGEST_WAIT, TERMS, Epochs
from proxy.core.limits import Limit

LIMIT = Limit("throughput", 1.0, 1000.0, Throughput(1000.0, 1.0))


def epochs(own, settled_at=0.5, started=0.0, left_at=0.0):
    return Epochs(
        own,
        (LIMIT,),
        settled_at=settled_at,
        started=started,
        turned=lambda: None,
        left_at=lambda now: max(now, left_at),
    )


def meet(now, *them, members=""):
    for each in them:
        each.set_members(now, members or [other.own for other in them])


def test_who_meets_nobody_leads_in_a_term_that_gives_way():
    """Once settled; a team that is there is followed, whatever the tags are."""
    newcomer, leader = epochs("a", settled_at=8.5, started=8.0), epochs("b")
    leader.set_members(0.0, "bc")
    leader.heard(1.0, "c", 0)
    assert leader.leads
    newcomer.look(8.5)
    assert newcomer.confirmed(8.5)
    assert newcomer.epoch >> 32 == 0
    meet(9.0, newcomer, leader, members="abc")
    assert not newcomer.confirmed(9.0)
    newcomer.heard(9.1, "b", leader.epoch)
    assert (newcomer.leader, newcomer.epoch) == ("b", leader.epoch)


def test_who_took_long_to_meet_others_waits_long_for_who_leads_them():
    """What took a second to notice takes seconds to answer; but when all have spoken there is nothing to wait for."""
    first, second = epochs("a", settled_at=2.0), epochs("a", settled_at=2.0)
    meet(1.0, first, members="abc")
    meet(1.0, second, members="abc")
    assert not first.confirmed(2.0)
    assert not first.confirmed(3.0)
    first.look(1.0 + LONGEST_WAIT)
    assert first.leads
    second.heard(1.5, "b", 0)
    second.heard(3.5, "c", 0)
    assert second.leads


def test_who_sent_in_another_epoch_follows_when_that_has_left_the_windows():
    """It holds nothing meanwhile, and time alone makes it follow."""
    a, b = epochs("a"), epochs("b", left_at=7.0)
    meet(0.0, a, b)
    a.look(0.5)
    b.heard(0.6, "a", a.epoch)
    a.heard(0.7, "b", b.epoch)
    assert b.leader == "a"
    a.heard(5.0, "b", (b.epoch >> 32) + 1 << 32 | 1)
    again = a.epoch + (1 << 32)
    assert b.heard(5.0, "a", again) is False
    assert (b.leader, b.epoch) == ("", a.epoch)
    assert b.due_at(5.0) == 7.0
    b.look(7.0)
    assert b.confirmed(7.0)
    assert (b.leader, b.epoch, b.due_at(7.0)) == ("a", again, float("inf"))


def test_whom_we_were_about_to_follow_may_be_gone_before():
    """Then somebody else leads: here we do, in the next term, and one window later."""
    a, b = epochs("a"), epochs("b", left_at=9.0)
    meet(0.0, a, b)
    a.look(0.5)
    b.heard(0.6, "a", a.epoch)
    b.heard(5.0, "a", a.epoch + (1 << 32))
    b.forget("a")
    b.set_members(6.0, "b")
    assert b.leads
    assert b.epoch >> 32 == (a.epoch >> 32) + 2
    assert b.due_at(6.0) == pytest.approx(6.0 + LIMIT.window + EDGE)
    assert b.confirmed(7.1)


def test_what_a_robot_may_have_sent_that_leaves_before_it_follows_is_waited_for():
    """Who leads does not know what it sent until then."""
    a = epochs("a")
    a.set_members(0.0, "abc")
    a.look(0.5)
    a.heard(0.6, "b", a.epoch)
    a.set_members(4.0, "ab")
    assert not a.confirmed(4.9)
    assert a.confirmed(5.1)


@pytest.mark.parametrize("gone", ["c", "d", "e", "f"])
def test_terms_that_are_used_up_begin_anew(gone):
    """Whoever led in the last term there is, or said so: when it is gone there is a next one, and all follow."""
    a, b, last = epochs("a"), epochs("b"), epochs(gone)
    meet(0.0, a, b, last, members=["a", "b", gone])
    epoch = TERMS << 32 | last._hash(gone)
    for each in (a, b):
        each.heard(1.0, gone, epoch)
        each.look(2.0)
        assert each.leader == gone
        each.heard(2.0, "b" if each is a else "a", epoch)
        each.forget(gone)
    a.set_members(3.0, "ab")
    b.set_members(3.0, "ab")
    b.heard(3.1, "a", a.epoch)
    assert (a.leader, b.leader) == ("a", "a")


def test_a_robot_alone_keeps_leading_under_other_limits():
    """It has nobody to wait for."""
    alone = epochs("a")
    alone.look(0.5)
    assert alone.confirmed(0.5)
    before = alone.epoch
    alone.set_limits(1.0, (replace(LIMIT, limit=900.0),), free=True)
    assert alone.epoch == before
    alone.set_limits(1.0, (replace(LIMIT, measure=Throughput(2000.0, 1.0)),), free=True)
    assert alone.epoch > before
    assert alone.confirmed(1.0)


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("heard"), st.sampled_from("abcd"), st.sampled_from((0, "ours", 1 << 32, 9 << 32))),
            st.tuples(st.just("forget"), st.sampled_from("abcd"), st.none()),
            st.tuples(st.just("members"), st.sets(st.sampled_from("abcd")), st.none()),
        ),
        max_size=20,
    )
)
def test_who_lags_behind_is_known_whatever_was_said(happened):
    """As if it were looked for anew each time; and who leads knows it."""
    ours = epochs("b")
    ours.set_members(0.0, "abcd")
    said = {}
    for number, (what, who, number_or_ours) in enumerate(happened, start=1):
        epoch = ours.epoch if number_or_ours == "ours" else number_or_ours
        if what == "heard":
            ours.heard(float(number), who, epoch)
            said |= {who: epoch} if who in ours.members else {}
        elif what == "forget":
            ours.forget(who)
            said.pop(who, None)
        else:
            ours.set_members(float(number), who)
        assert ours.stragglers == sorted(m for m in ours.members - {"b"} if said.get(m) != ours.epoch)
        assert ours.leads == (ours.leader == "b")
