"""Shares: the union of all robots' sends never exceeds a limit, whatever happens to digests."""

import random
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner.measures import Energy, Messages, Throughput
from proxy.core.limits import Limit
from proxy.core.shares import Shares

LIMIT = Limit("throughput", 1.0, 1000.0, Throughput(1000.0, 1.0))
BATTERY = Limit("energy", 1.0, 2.0, Energy(2.0, 1.0, per_byte=1e-3))


def team(names, now=0.0, floor=0.01):
    shares = {name: Shares(name, (LIMIT,), floor=floor, settled_at=now + 0.05) for name in names}
    for share in shares.values():
        share.set_members(now, names)
        assert share.held(now, 0) == pytest.approx(floor * LIMIT.limit)
    return shares


def tell(shares, sender, receivers, now):
    """A digest of `sender` reaches `receivers`."""
    for receiver in receivers:
        shares[receiver].heard(sender, shares[sender].announced(now), shares[sender].grants())


def agree(shares, now):
    for sender in shares:
        tell(shares, sender, [r for r in shares if r != sender], now)


def test_members_hold_equal_parts_once_all_agree():
    """Before, a newcomer holds the floor; after, the limit less the floor is split evenly."""
    shares = team(["a", "b", "c"])
    agree(shares, 0.1)
    assert [s.held(0.1, 0) for s in shares.values()] == pytest.approx([330.0] * 3)
    assert shares["a"].confirmed(0.1)


def test_a_robot_alone_holds_everything_once_settled():
    """Who hears nobody for the settling time has the channel."""
    alone = Shares("a", (LIMIT,), floor=0.01, settled_at=5.0)
    assert alone.held(4.9, 0) == pytest.approx(10.0)
    assert alone.held(5.0, 0) == pytest.approx(990.0)


def test_a_grant_moves_only_what_is_free():
    """What is in use stays; the receiver holds more when it hears of the grant, the giver less at once."""
    shares = team(["a", "b"])
    agree(shares, 0.1)
    shares["a"].use(0.1, (400.0,))
    assert shares["a"].grant(0.5, "b", 0, 300.0) == 95.0
    assert shares["a"].held(0.5, 0) == pytest.approx(400.0)
    assert shares["b"].held(0.5, 0) == pytest.approx(495.0)
    tell(shares, "a", ["b"], 0.6)
    tell(shares, "a", ["b"], 0.7)
    assert shares["b"].held(0.7, 0) == pytest.approx(590.0)


def test_a_grant_to_a_stranger_is_refused():
    """Only members of a confirmed epoch are given anything."""
    shares = team(["a", "b"])
    assert shares["a"].grant(0.1, "b", 0, 10.0) == 0.0
    agree(shares, 0.1)
    assert shares["a"].grant(0.1, "x", 0, 10.0) == 0.0
    assert shares["a"].grant(0.1, "a", 0, 10.0) == 0.0


def test_a_newcomer_waits_until_those_who_were_there_give_way():
    """The old members lower their sends first and announce it; only then the newcomer rises."""
    shares = team(["a", "b"])
    agree(shares, 0.1)
    shares["a"].use(0.1, (495.0,))
    shares["c"] = Shares("c", (LIMIT,), floor=0.01, settled_at=0.3)
    for share in shares.values():
        share.set_members(0.2, ["a", "b", "c"])
    agree(shares, 0.3)
    assert shares["c"].held(0.3, 0) == pytest.approx(10.0)
    agree(shares, 1.2)
    assert shares["c"].held(1.2, 0) == pytest.approx(330.0)


def test_a_message_larger_than_the_limit_goes_through_a_stretched_window():
    """It is sent rarely: not again before its bytes fit what the robot may use on average."""
    alone = Shares("a", (LIMIT,), floor=0.0, settled_at=0.0)
    assert alone.fits(0.0, (2500.0,))
    alone.use(0.0, (2500.0,))
    assert not alone.fits(2.4, (2500.0,))
    assert alone.fits(2.6, (2500.0,))


@pytest.mark.parametrize("amount", [985.0, 1000.0])
def test_a_message_as_large_as_the_limit_can_be_sent(amount):
    """Nobody can hold the whole limit, so it too has its window stretched."""
    alone = Shares("a", (LIMIT,), floor=0.01, settled_at=0.0)
    assert alone.fits(0.0, (amount,))


def test_uncovered_traffic_lowers_what_is_left_down_to_a_floor():
    """It counts, but the covered streams keep their part."""
    alone = Shares("a", (LIMIT,), floor=0.0, settled_at=0.0)
    alone.use_at_most(0.0, (700.0,), 0.9)
    assert alone.free(0.0, 0) == pytest.approx(300.0)
    alone.use_at_most(0.1, (700.0,), 0.9)
    assert alone.free(0.1, 0) == pytest.approx(100.0)


def test_changed_limits_start_a_new_epoch_and_keep_what_was_sent():
    """A lower limit holds at once; a higher one when all have it."""
    shares = team(["a", "b"])
    agree(shares, 0.1)
    shares["a"].use(0.1, (100.0,))
    epoch = shares["a"].epoch
    shares["a"].set_limits(0.2, (Limit("other", 1.0, 7.0, Messages(7)), replace(LIMIT, limit=2000.0)))
    assert shares["a"].epoch != epoch
    assert shares["a"].held(0.2, 1) == pytest.approx(495.0)
    assert shares["a"].used(0.2, 1) == pytest.approx(100.0)
    assert shares["a"].used(0.2, 0) == 0.0
    assert not shares["a"].confirmed(0.2)


def test_a_constraint_of_another_kind_is_another_one():
    """Amounts in one unit say nothing of those in another."""
    shares = team(["a", "b"])
    agree(shares, 0.1)
    shares["a"].use(0.1, (400.0,))
    shares["a"].set_limits(0.2, (Limit(LIMIT.name, 1.0, 500.0, Messages(500)),))
    assert (shares["a"].held(0.2, 0), shares["a"].used(0.2, 0)) == (0.0, 0.0)


def test_what_is_not_shared_is_held_whole():
    """Before anybody agreed and after; it can be used up to the limit, and not be granted."""
    shares = {name: Shares(name, (LIMIT, BATTERY), floor=0.01, settled_at=0.05) for name in "ab"}
    for share in shares.values():
        share.set_members(0.0, "ab")
        assert share.held(0.0, 1) == 2.0
    agree(shares, 0.1)
    assert shares["a"].grant(0.1, "b", 1, 1.0) == 0.0
    assert shares["a"].fits(0.1, (0.0, 2.0))
    shares["a"].use(0.1, (0.0, 2.0))
    assert not shares["a"].fits(0.2, (0.0, 0.1))
    assert shares["b"].fits(0.2, (0.0, 0.1))


def test_robots_agree_whatever_each_one_has_for_itself():
    """A robot with a battery shares the channel with one on the mains."""
    shares = {"a": Shares("a", (LIMIT, BATTERY), floor=0.01, settled_at=0.05)}
    shares["b"] = Shares("b", (LIMIT,), floor=0.01, settled_at=0.05)
    for share in shares.values():
        share.set_members(0.0, "ab")
    agree(shares, 0.1)
    assert [share.confirmed(0.1) for share in shares.values()] == [True, True]


def test_a_large_message_that_fits_the_limit_waits_a_whole_window():
    """Its window is stretched, never shortened."""
    alone = Shares("a", (LIMIT,), floor=0.0, settled_at=0.0)
    alone.use(0.0, (990.0,))
    assert not alone.fits(0.995, (990.0,))
    assert alone.fits(1.01, (990.0,))


def test_small_units_are_granted_too():
    """Tenths of a second of airtime move like thousands of bytes, in parts of the limit."""
    air = Limit("airtime", 1.0, 0.2, Throughput(0.2, 1.0))
    shares = {name: Shares(name, (air,), floor=0.0, settled_at=0.05) for name in "ab"}
    for share in shares.values():
        share.set_members(0.0, "ab")
    agree(shares, 0.1)
    assert shares["a"].grant(0.1, "b", 0, 0.05) == pytest.approx(0.05)
    tell(shares, "a", ["b"], 0.2)
    assert shares["b"].held(0.2, 0) == pytest.approx(0.15)


def test_a_member_that_flaps_finds_its_grants_again():
    """Leaving and coming back does not forget what was given away."""
    shares = team(["a", "b"])
    agree(shares, 0.1)
    shares["a"].grant(0.1, "b", 0, 200.0)
    shares["a"].set_members(0.2, [])
    shares["a"].forget("b")
    shares["a"].set_members(0.3, ["b"])
    assert shares["a"].held(0.3, 0) == pytest.approx(295.0)


@hypothesis_settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.integers(2, 5), st.floats(0.0, 0.6))
def test_the_union_holds_under_loss_delay_and_reordering(seed, robots, loss):
    """Robots send all they can, grant at random, and digests are lost, late and out of order: Eq. 5 holds."""
    rng = random.Random(seed)
    names = [f"r{i}" for i in range(robots)]
    shares = {name: Shares(name, (LIMIT,), floor=0.01, settled_at=30.0) for name in names}
    known = {name: {name} for name in names}
    sends, mail, now = [], [], 0.0
    for _ in range(900):
        now += rng.random() * 0.1
        name = rng.choice(names)
        if rng.random() < 0.3 and len(known[name]) < robots:
            known[name].add(rng.choice(names))
            shares[name].set_members(now, known[name])
        if len(known[name]) == robots:
            letter = (name, shares[name].announced(now), shares[name].grants())
            mail += [(now + rng.random(), r, *letter) for r in names if r != name]
        for letter in [m for m in mail if m[0] <= now]:
            mail.remove(letter)
            if rng.random() >= loss:
                shares[letter[1]].heard(*letter[2:])
        if len(known[name]) == robots:
            shares[name].grant(now, rng.choice(names), 0, rng.random() * 300.0)
            amount = rng.choice([10.0, shares[name].free(now, 0)])
            if amount > 0.0 and shares[name].fits(now, (amount,)):
                shares[name].use(now, (amount,))
                sends.append((now, amount))
        window = sum(amount for t, amount in sends if t >= now - LIMIT.window)
        assert window <= LIMIT.limit + 1e-6


@given(st.lists(st.floats(0.05, 1.0), min_size=3, max_size=3))
def test_the_union_keeps_the_greatest_part_in_force(factors):
    """Robots that agree on the ceiling apply a part of it each, in the same epoch; grants are of what is in force."""
    shares = team(["a", "b", "c"])
    agree(shares, 0.1)
    epochs = {share.epoch for share in shares.values()}
    for share, factor in zip(shares.values(), factors, strict=True):
        share.set_factor(0, factor)
    given = shares["a"].grant(0.2, "b", 0, 100.0 * factors[0])
    assert given == pytest.approx(100.0 * factors[0], rel=1e-3)
    agree(shares, 0.3)
    held = [share.held(0.3, 0) for share in shares.values()]
    assert sum(held) <= max(factors) * LIMIT.limit
    assert held[1] == pytest.approx(430.0 * factors[1], rel=1e-3)
    assert {share.epoch for share in shares.values()} == epochs
    assert not shares["c"].fits(0.3, (held[2] + 1.0,))
