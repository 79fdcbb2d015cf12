"""Shares: the union of all robots' sends never exceeds a limit, whatever happens to digests."""

import random
from dataclasses import replace
from functools import partial

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner.measures import Energy, Messages, Throughput
from proxy.core.limits import Limit
from proxy.core.shares import LONG, MOST_GRANTS, NEWCOMERS, Shares

LIMIT = Limit("throughput", 1.0, 1000.0, Throughput(1000.0, 1.0))
BATTERY = Limit("energy", 1.0, 2.0, Energy(2.0, 1.0, per_byte=1e-3))


def team(names, now=0.0, floor=0.01, limits=(LIMIT,)):
    shares = {name: Shares(name, limits, floor=floor, settled_at=now + 0.05) for name in names}
    for share in shares.values():
        share.set_members(now, names)
    return shares


def tell(shares, sender, receivers, now):
    """A digest of `sender` reaches `receivers`."""
    for receiver in receivers:
        shares[receiver].heard(now, sender, shares[sender].epoch, shares[sender].grants(now))


def agree(shares, now):
    """All hear each other, and then again, so that they enter the epoch of who leads and say so."""
    for _ in range(2):
        for sender in shares:
            tell(shares, sender, [r for r in shares if r != sender], now)


def test_one_robot_holds_all_once_all_follow_it():
    """That with the least tag; the others hold what it lends, and a newcomer a part of the floor before."""
    shares = team("abc")
    assert [s.held(0.0, 0) for s in shares.values()] == [10.0 / NEWCOMERS] * 3
    agree(shares, 0.1)
    assert [s.held(0.1, 0) for s in shares.values()] == pytest.approx([990.0, 0.0, 0.0])
    assert all(s.confirmed(0.1) for s in shares.values())
    assert [s.leads for s in shares.values()] == [True, False, False]


def test_nobody_leads_before_others_were_heard():
    """Who heard that some follow somebody else waits until all have spoken."""
    shares = Shares("a", (LIMIT,), floor=0.01, settled_at=0.0)
    shares.set_members(-1.0, "abc")
    shares.heard(-1.0, "b", 5 << 32)
    shares.set_members(0.0, "abc")
    assert not shares.leads
    shares.heard(0.1, "c", 0)
    assert shares.leads
    assert shares.epoch >> 32 == 6


def test_a_robot_alone_holds_everything_once_settled():
    """Who hears nobody for the settling time has the channel."""
    alone = Shares("a", (LIMIT,), floor=0.01, settled_at=5.0)
    alone.look(4.9)
    assert alone.held(4.9, 0) == pytest.approx(10.0 / NEWCOMERS)
    alone.look(5.0)
    assert alone.held(5.0, 0) == pytest.approx(990.0)


def test_what_is_lent_is_gone_until_one_window_after_its_end():
    """The other one has it from the begin, may send until the end, and the leader gets it back by itself."""
    shares = team("ab")
    agree(shares, 0.1)
    lent = shares["a"].lend(0.1, "b", 1.0, 1.5, (300.0,))
    assert (lent.begins, lent.ends) == (pytest.approx(1.001), 1.5)
    tell(shares, "a", "b", 0.2)
    assert [shares["a"].held(t, 0) for t in (0.9, 1.1, 2.49, 2.6)] == pytest.approx([990.0, 690.0, 690.0, 990.0])
    assert [shares["b"].fits(t, (300.0,)) for t in (0.9, 1.1, 1.5, 1.6)] == [False, True, True, False]
    assert shares["b"].opens(0.9, (300.0,), 1.2) == pytest.approx(1.001)
    assert shares["b"].opens(0.9, (300.0,), 0.95) is None
    assert shares["b"].holds(1.1, 1.4, (300.0,))
    assert not shares["b"].holds(1.1, 1.6, (300.0,))
    assert shares["a"].lent(2.4) == (lent,)
    assert shares["a"].lent(2.6) == ()


def test_the_leader_does_not_send_what_is_lent_for_later():
    """Its own send would still be in the window when the other one begins."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"].lend(0.1, "b", 1.0, 1.5, (700.0,))
    assert shares["a"].fits(0.1, (290.0,))
    assert not shares["a"].fits(0.1, (300.0,))
    assert shares["a"].opens(0.1, (300.0,), 9.0) == pytest.approx(2.501)


def test_a_grant_begins_when_what_it_takes_comes_back():
    """As early as asked for if possible; not at all when its end is before that, or for strangers."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"].use(0.1, (990.0,))
    assert shares["a"].lend(0.2, "b", 0.5, 1.0, (100.0,)) is None
    assert shares["a"].lend(0.2, "b", 0.5, 1.5, (100.0,)).begins == pytest.approx(1.1, abs=0.01)
    assert shares["a"].lend(0.2, "x", 5.0, 6.0, (1.0,)) is None
    assert shares["a"].lend(0.2, "a", 5.0, 6.0, (1.0,)) is None
    assert shares["b"].lend(0.2, "a", 5.0, 6.0, (1.0,)) is None


def test_who_may_be_wrong_about_the_leaders_clock_uses_less_of_the_time():
    """The clock of the leader is 100 s ahead, give or take 0.1 s."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"].lend(0.1, "b", 101.0, 102.0, (300.0,))
    ours = partial(lambda by, t: t - by, 100.0)
    shares["b"].heard(0.2, "a", shares["a"].epoch, shares["a"].grants(0.1), ours=ours, uncertainty=0.1)
    assert [shares["b"].fits(t, (300.0,)) for t in (1.05, 1.15, 1.85, 1.95)] == [False, True, True, False]


def test_a_grant_heard_twice_counts_once():
    """Digests are repeated and duplicated; what another robot than the leader lends counts nothing."""
    shares = team("abc")
    agree(shares, 0.1)
    shares["a"].lend(0.1, "b", 0.2, 1.0, (300.0,))
    for now in (0.2, 0.3):
        tell(shares, "a", "b", now)
    shares["b"].heard(0.3, "c", shares["c"].epoch, shares["a"].grants(0.3))
    assert shares["b"].held(0.5, 0) == pytest.approx(300.0)
    shares["b"].heard(0.3, "stranger", shares["c"].epoch)
    assert shares["b"].held(0.5, 0) == pytest.approx(300.0)


def test_of_a_limit_that_moved_who_leads_lends_no_more_than_is_in_force():
    """What is lent stays lent, as whole messages need it, but nobody uses more than it takes to be in force itself."""
    shares = team("ab")
    agree(shares, 0.1)
    epoch = shares["a"].epoch
    for share in shares.values():
        share.set_factor(0, 0.5)
    assert shares["a"].lend(0.1, "b", 0.2, 1.0, (400.0,))
    assert shares["a"].lend(0.1, "b", 0.2, 1.0, (100.0,)) is None
    tell(shares, "a", "b", 0.1)
    assert [s.held(0.5, 0) for s in shares.values()] == pytest.approx([95.0, 400.0])
    for share in shares.values():
        share.set_factor(0, 0.2)
    assert [s.held(0.5, 0) for s in shares.values()] == pytest.approx([0.0, 200.0])
    assert shares["a"].epoch == epoch
    shares["b"].set_factor(0, 7.0)
    assert shares["b"].held(0.5, 0) == pytest.approx(400.0)


def test_when_the_leader_is_gone_another_one_waits_for_what_was_lent():
    """It is in force when all follow it, and what they sent before has left the windows."""
    shares = team("abc")
    agree(shares, 0.1)
    shares["a"].lend(0.1, "c", 0.2, 5.0, (900.0,))
    tell(shares, "a", "bc", 0.1)
    gone = shares.pop("a")
    for share in shares.values():
        share.forget("a")
        share.set_members(1.0, "bc")
    assert shares["c"].fits(1.0, (900.0,))
    agree(shares, 1.2)
    assert shares["b"].leads
    assert not shares["c"].fits(1.2, (900.0,))
    assert not shares["b"].confirmed(1.9)
    assert shares["b"].held(2.1, 0) == pytest.approx(990.0)
    gone.set_members(2.4, "abc")
    gone.heard(2.4, "b", shares["b"].epoch)
    assert gone.held(2.4, 0) == 0.0


def test_a_newcomer_does_not_disturb_who_leads():
    """Even if its tag is less; it is lent to as soon as it is there."""
    shares = team("bc")
    agree(shares, 0.1)
    shares["a"] = Shares("a", (LIMIT,), floor=0.01, settled_at=1.0)
    for share in shares.values():
        share.set_members(0.5, "abc")
    tell(shares, "b", "a", 0.5)
    assert [s.leader for s in shares.values()] == ["b", "b", "b"]
    assert shares["b"].lend(0.5, "a", 0.6, 1.0, (100.0,)) is not None


def test_two_teams_that_meet_follow_the_later_leader():
    """The other one gives way, and holds nothing from then on."""
    one, two = team("ab"), team("cd")
    agree(one, 0.1)
    agree(two, 0.1)
    shares = one | two
    for share in shares.values():
        share.set_members(5.0, "abcd")
    tell(shares, "a", "cd", 5.0)
    tell(shares, "c", "ab", 5.0)
    agree(shares, 5.1)
    leaders = {share.leader for share in shares.values()}
    assert len(leaders) == 1
    assert sorted(share.held(6.2, 0) for share in shares.values()) == pytest.approx([0.0, 0.0, 0.0, 990.0])


def test_a_robot_that_led_before_leads_in_another_term():
    """What it lent then nobody remembers but the others: it does not enter that epoch again."""
    shares = team("ab")
    agree(shares, 0.1)
    again = Shares("a", (LIMIT,), floor=0.01, settled_at=9.0)
    again.set_members(8.0, "ab")
    again.heard(8.0, "b", shares["b"].epoch)
    assert again.leads
    assert again.epoch > shares["b"].epoch


def test_no_more_is_lent_than_can_be_kept():
    """There is a bound on what is alive at the same time."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"]._lent = [shares["a"].lend(0.1, "b", 1.0, 1.5, (0.01,))] * MOST_GRANTS
    assert shares["a"].lend(0.1, "b", 1.0, 1.5, (0.01,)) is None


def test_a_message_larger_than_the_limit_goes_through_a_stretched_window():
    """It is sent rarely: not again before its bytes fit what the robot may use on average."""
    alone = Shares("a", (LIMIT,), floor=0.0, settled_at=0.0)
    alone.look(0.0)
    assert alone.fits(0.0, (2500.0,))
    alone.use(0.0, (2500.0,))
    assert not alone.fits(2.4, (2500.0,))
    assert alone.fits(2.6, (2500.0,))


def test_a_message_larger_than_the_limit_is_lent_all_of_it():
    """From as long before as its bytes take to one window after, nobody else is lent anything or sends."""
    shares = team("abc")
    agree(shares, 0.1)
    a, b = shares["a"], shares["b"]
    assert a.reserved((500.0,)) == 0.0
    assert a.reserved((1980.0,)) == pytest.approx(2.0)
    first = a.lend(0.1, "c", 0.2, 0.3, (10.0,))
    assert a.lend(0.1, "b", 2.2, 2.3, (1980.0,)) is None
    lent = a.lend(0.1, "b", 2.5, 2.6, (1980.0,))
    assert lent.begins == pytest.approx(first.ends + 2.0 + 0.2, abs=0.1)
    assert a.lend(0.1, "c", 1.0, 1.6, (10.0,)) is None
    assert a.lend(0.1, "c", 2.7, 3.5, (10.0,)) is None
    assert a.lend(0.1, "c", 3.7, 3.8, (10.0,)) is not None
    tell(shares, "a", "bc", 0.2)
    assert not b.fits(2.4, (1980.0,))
    assert b.holds(2.55, 2.56, (1980.0,))
    assert b.opens(2.4, (1980.0,), 2.6) == pytest.approx(lent.begins)
    assert b.fits(2.55, (1980.0,))
    b.use(2.55, (1980.0,))
    assert not b.fits(2.56, (10.0,))


def test_who_leads_sends_a_message_larger_than_the_limit_when_nothing_is_lent():
    """Not while others may send, nor so soon that what they sent is within its bytes' time."""
    shares = team("ab")
    agree(shares, 0.1)
    a = shares["a"]
    assert a.fits(0.1, (1980.0,))
    lent = a.lend(0.1, "b", 0.2, 0.3, (10.0,))
    assert not a.fits(0.1, (1980.0,))
    assert not a.fits(2.2, (1980.0,))
    assert a.opens(2.2, (1980.0,), 2.4) == pytest.approx(lent.ends + 2.0, abs=0.01)


@pytest.mark.parametrize("amount", [985.0, 1000.0])
def test_a_message_as_large_as_the_limit_can_be_sent(amount):
    """Nobody can hold the whole limit, so it too has its window stretched."""
    alone = Shares("a", (LIMIT,), floor=0.01, settled_at=0.0)
    alone.look(0.0)
    assert alone.fits(0.0, (amount,))


def test_uncovered_traffic_lowers_what_is_left_down_to_a_floor():
    """It counts, but the covered streams keep their part."""
    alone = Shares("a", (LIMIT,), floor=0.0, settled_at=0.0)
    alone.use_at_most(0.0, (700.0,), 0.9)
    assert alone.free(0.0, 0) == pytest.approx(300.0)
    alone.use_at_most(0.1, (700.0,), 0.9)
    assert alone.free(0.1, 0) == pytest.approx(100.0)


def test_other_ceilings_start_a_new_epoch_and_keep_what_was_sent():
    """Until all have them, who has them does not follow who has not; what was sent still counts."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"].use(0.1, (100.0,))
    epoch, other = shares["a"].epoch, Limit("other", 1.0, 7.0, Messages(7))
    changed = (other, replace(LIMIT, limit=2000.0, measure=Throughput(2000.0, 1.0)))
    shares["b"].set_limits(0.2, changed)
    assert shares["b"].leader == ""
    shares["a"].set_limits(0.2, changed)
    assert shares["a"].epoch > epoch
    assert (shares["a"].used(0.2, 0), shares["a"].used(0.2, 1)) == (0.0, pytest.approx(100.0))
    agree(shares, 0.3)
    assert shares["a"].held(1.4, 1) == pytest.approx(1980.0)


def test_what_digests_leave_of_a_limit_may_change_without_a_new_epoch():
    """Robots come and go; the ceilings stay."""
    shares = team("ab")
    agree(shares, 0.1)
    epoch = shares["a"].epoch
    shares["a"].set_limits(0.2, (replace(LIMIT, limit=900.0),))
    assert (shares["a"].epoch, shares["a"].held(0.2, 0)) == (epoch, pytest.approx(891.0))


def test_a_constraint_of_another_kind_is_another_one():
    """Amounts in one unit say nothing of those in another."""
    alone = Shares("a", (LIMIT,), floor=0.01, settled_at=0.0)
    alone.use(0.1, (400.0,))
    alone.set_limits(0.2, (Limit(LIMIT.name, 1.0, 500.0, Messages(500)),))
    assert alone.used(0.2, 0) == 0.0


def test_what_is_not_shared_is_held_whole():
    """Before anybody agreed and after; it can be used up to the limit, and is not lent."""
    shares = team("ab", limits=(LIMIT, BATTERY))
    assert [share.held(0.0, 1) for share in shares.values()] == [2.0, 2.0]
    agree(shares, 0.1)
    assert shares["a"].fits(0.1, (0.0, 2.0))
    shares["a"].use(0.1, (0.0, 2.0))
    assert not shares["a"].fits(0.2, (0.0, 0.1))
    assert shares["b"].fits(0.2, (0.0, 0.1))


def test_robots_agree_whatever_each_one_has_for_itself():
    """A robot with a battery shares the channel with one on the mains."""
    shares = team("a", limits=(LIMIT, BATTERY)) | team("b")
    for share in shares.values():
        share.set_members(0.0, "ab")
    agree(shares, 0.1)
    assert [share.confirmed(0.1) for share in shares.values()] == [True, True]


class Mission:
    """Robots that come, go and meet again, and digests that are lost, late, repeated and out of order."""

    delay, noticed = 0.8, 0.3

    def __init__(self, rng, robots, loss):
        self.rng, self.loss = rng, loss
        self.names = [f"r{i}" for i in range(robots)]
        self.clocks = {name: rng.uniform(-50.0, 50.0) for name in self.names}
        self.shares, self.zids, self.mail, self.sends, self.now = {}, 0, [], [], 100.0
        for name in self.names:
            self.join(name)

    def clock(self, name):
        return self.now + self.clocks[name]

    def join(self, name):
        settled = self.clock(name) + 1.0
        self.shares[name] = Shares(name, (LIMIT,), floor=0.01, settled_at=settled)
        for other in self.shares:
            self.shares[other].set_members(self.clock(other), self.shares)

    def flap(self, name, other):
        """`name` loses sight of `other` for a moment, while all others see both."""
        self.shares[name].forget(other)
        self.shares[name].set_members(self.clock(name), set(self.shares) - {other})
        self.shares[name].set_members(self.clock(name), self.shares)

    def speak(self, name):
        letter = name, self.shares[name].epoch, self.shares[name].grants(self.clock(name))
        letter = *letter, self.shares[name].returned(self.clock(name))
        self.shares[name].told_returned()
        for to in self.shares:
            for _ in range(self.rng.choice([1, 1, 2])):
                if to != name and self.rng.random() >= self.loss:
                    self.mail.append((self.now + self.rng.random() * self.delay, to, *letter))

    def hear(self):
        due = [letter for letter in self.mail if letter[0] <= self.now]
        self.mail = [letter for letter in self.mail if letter[0] > self.now]
        for _, to, by, epoch, grants, returned in due:
            wrong = self.rng.uniform(-0.1, 0.1)
            offset = self.clocks[to] - self.clocks[by] + wrong
            ours = partial(lambda offset, t: t + offset, offset)
            self.shares[to].heard(self.clock(to), by, epoch, grants, ours=ours, uncertainty=0.1)
            latest = partial(lambda offset, t: t + offset + 0.1, offset)
            self.shares[to].take_back(by, epoch, returned, latest)

    def act(self, name):
        share, now = self.shares[name], self.clock(name)
        begins = now + self.rng.random() * 2.0
        share.lend(now, self.rng.choice(self.names), begins, begins + self.rng.random(), (self.rng.random() * 600.0,))
        amount = self.rng.choice([3.0, share.free(now, 0)])
        if 0.0 < amount < 980.0 and share.fits(now, (amount,)):
            share.use(now, (amount,))
            self.sends.append((self.now, amount))

    def worst(self):
        recent = [(t, amount) for t, amount in self.sends if t >= self.now - LIMIT.window]
        return sum(amount for _, amount in recent)


@hypothesis_settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(2, 5), st.floats(0.0, 0.6))
def test_the_union_holds_under_loss_delay_reordering_and_wrong_clocks(seed, robots, loss):
    """Robots lend and send at random, lose sight of each other for moments, and their clocks differ: Eq. 5 holds."""
    flight = Mission(random.Random(seed), robots, loss)
    for _ in range(500):
        flight.now += flight.rng.random() * 0.05
        name, other = flight.rng.choice(flight.names), flight.rng.choice(flight.names)
        if flight.rng.random() < 0.3:
            flight.speak(name)
        if robots > 2 and flight.rng.random() < 0.01 and other != name:
            flight.flap(name, other)
        flight.hear()
        flight.act(name)
        assert flight.worst() <= LIMIT.limit + 1e-6


class Churn(Mission):
    """The same, and robots join, leave, crash, and part from each other for good; each notices that later."""

    settle, prompt = 1.0, 0.0

    def __init__(self, rng, robots, loss):
        self.group, self.notices = {}, []
        super().__init__(rng, robots, loss)

    def together(self, name):
        return {other for other in self.shares if self.group[other] == self.group[name]}

    def join(self, name):
        self.group.setdefault(name, 0)
        self.clocks.setdefault(name, self.rng.uniform(-50.0, 50.0))
        now = self.clock(name)
        self.shares[name] = Shares(name, (LIMIT,), floor=0.01, settled_at=now + self.settle, started=now)
        for other in self.together(name):
            self.notices.append((self.now + self.noticed * self.rng.uniform(self.prompt, 1.0), other))

    def go(self, name, noticed):
        del self.shares[name]
        self.names.remove(name)
        self.notices += [(self.now + noticed, other) for other in self.shares]

    def part(self):
        for name in self.group:
            self.group[name] = 2 * self.group[name] + self.rng.randint(0, 1)
        self.notices += [(self.now + 2.0 + 0.3 * self.rng.random(), name) for name in self.names]

    def notice(self):
        due = [name for t, name in self.notices if t <= self.now]
        self.notices = [notice for notice in self.notices if notice[0] > self.now]
        for name in set(due) & set(self.shares):
            share, there = self.shares[name], self.together(name)
            for gone in share.members - there:
                share.forget(gone)
            share.set_members(self.clock(name), there)

    def deliver(self):
        self.mail = [m for m in self.mail if m[1] in self.shares and self.group[m[1]] == self.group[m[2]]]
        self.hear()

    def happen(self, number):
        """Robots are few, so what happens is seldom enough for a robot to be known when the next one comes."""
        match self.rng.randrange(300):
            case 0 if number < 8:
                self.names.append(f"n{number:03}")
                self.join(self.names[-1])
            case 1 | 2 if len(self.names) > 1:
                self.go(self.rng.choice(self.names), self.rng.choice([0.0, 2.0]))
            case 3:
                self.part()

    def act(self, name):
        super().act(name)
        if self.sends and len(self.sends[-1]) == 2:
            self.sends[-1] = (*self.sends[-1], name)

    def worst(self):
        recent = [(amount, self.group[name]) for t, amount, name in self.sends if t >= self.now - LIMIT.window]
        return max((sum(a for a, g in recent if g == group) for group in {g for _, g in recent}), default=0.0)

    def lengthen(self, name):
        for lent in self.shares[name].lent(self.clock(name))[-2:]:
            self.shares[name].lengthen(self.clock(name), lent, lent.ends + self.rng.random())


@hypothesis_settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(2, 5), st.floats(0.0, 0.4))
def test_robots_that_hear_each_other_never_exceed_whoever_comes_goes_and_parts(seed, robots, loss):
    """Joins, leaves, crashes noticed late and partitions: what the robots of one part send keeps Eq. 5."""
    fly(Churn(random.Random(seed), robots, loss))


def fly(flight):
    """In every window what all who hear each other send keeps the limit."""
    for number in range(700):
        flight.now += flight.rng.random() * 0.05
        flight.happen(number)
        flight.notice()
        name = flight.rng.choice(flight.names)
        if flight.rng.random() < 0.3:
            flight.speak(name)
        flight.deliver()
        flight.lengthen(name)
        flight.act(name)
        assert flight.worst() <= LIMIT.limit + 1e-6


class Slow(Churn):
    """The same where a robot has settled before it notices anybody, for whom alone it would send; nobody parts."""

    delay, noticed, settle, prompt = 1.2, 1.2, 0.5, 0.8

    def part(self):
        pass

    def act(self, name):
        if len(self.shares[name].members) > 1:
            super().act(name)


@hypothesis_settings(deadline=None, max_examples=15)
@given(st.integers(0, 10**6), st.integers(2, 5), st.floats(0.0, 0.4))
def test_robots_that_settle_before_they_meet_anybody_never_exceed(seed, robots, loss):
    """Who leads alone gives way to a team that is there already."""
    fly(Slow(random.Random(seed), robots, loss))


def test_a_slot_is_lengthened_and_stays_one():
    """Its robot has it once, however often it is told; what is lent to others by then stops it."""
    shares = team("abc")
    agree(shares, 0.1)
    slot = shares["a"].lend(0.1, "b", 0.1, 3.0, (300.0,))
    tell(shares, "a", "b", 0.2)
    longer = shares["a"].lengthen(1.0, slot, 5.0)
    assert (longer.begins, longer.ends) == (slot.begins, 5.0)
    assert shares["a"].lengthen(1.0, slot, 6.0) is None
    tell(shares, "a", "b", 1.1)
    assert [shares["b"].held(t, 0) for t in (1.0, 4.9, 6.1)] == pytest.approx([300.0, 300.0, 0.0], abs=0.1)
    assert shares["b"].stays(1.1)
    assert shares["b"].holds(1.1, 30.0, (300.0,))
    assert shares["a"].lend(1.2, "c", 6.1, 6.5, (800.0,)) is not None
    assert shares["a"].lengthen(1.2, longer, 6.5) is None
    assert longer in shares["a"].lent(1.2)


def test_slots_for_one_robot_are_told_apart():
    """Two of the same amount, lent at the same time, begin at other times."""
    shares = team("ab")
    agree(shares, 0.1)
    slots = [shares["a"].lend(0.1, "b", 0.1, 3.0, (300.0,)) for _ in range(3)]
    assert len({slot.begins for slot in slots}) == 3
    tell(shares, "a", "b", 0.2)
    assert shares["b"].held(0.3, 0) == pytest.approx(900.0)


def lending(now=0.1, ends=1.5):
    """A team of two in which 300 B are lent to `b` from 1.0 on."""
    shares = team("ab")
    agree(shares, now)
    shares["a"].lend(now, "b", 1.0, ends, (300.0,))
    tell(shares, "a", "b", 0.2)
    return shares


def give_back(shares, now, wrong=0.0):
    """What `b` gives back reaches `a`, whose clock may be ahead by `wrong`."""
    returned = shares["b"].returned(now)
    unused = shares["a"].take_back("b", shares["b"].epoch, returned, partial(lambda by, t: t + by, wrong))
    shares["b"].told_returned()
    return returned, unused


def test_what_has_served_comes_back_one_window_after_it_was_used():
    """Who lends may lend it again by then; until it has heard of it, nothing changes."""
    shares = lending()
    shares["b"].use(1.1, (300.0,))
    assert [shares["a"].held(t, 0) for t in (2.2, 2.6)] == pytest.approx([690.0, 990.0])
    returned, unused = give_back(shares, 1.2)
    assert ([each.used for each in returned], unused) == ([1.1], [])
    assert [shares["a"].held(t, 0) for t in (2.0, 2.2)] == pytest.approx([690.0, 990.0])
    assert shares["a"].grants(1.3) == ()
    assert not shares["b"].fits(1.3, (20.0,))


def test_what_is_given_back_is_told_twice():
    """Digests may be lost."""
    shares = lending()
    shares["b"].use(1.1, (300.0,))
    assert [len(give_back(shares, t)[0]) for t in (1.2, 1.3, 1.4)] == [1, 1, 0]


def test_what_was_not_used_comes_back_at_once():
    """When it is over, for it might have been used until then."""
    shares = lending()
    assert give_back(shares, 1.4) == ((), [])
    (lent,) = shares["a"].lent(1.5)
    returned, unused = give_back(shares, 1.6)
    assert ([each.used for each in returned], unused) == ([0.0], [lent])
    assert shares["a"].held(1.7, 0) == pytest.approx(990.0)
    assert shares["b"].held(1.7, 0) == 0.0


def test_what_may_have_been_used_at_the_end_is_not_back_sooner():
    """Who lends does not know the other one's clock that well."""
    shares = lending()
    shares["b"].use(1.1, (300.0,))
    give_back(shares, 1.2, wrong=5.0)
    assert shares["a"].held(2.4, 0) == pytest.approx(690.0)


def test_only_who_lends_takes_back_what_it_lent_itself_in_this_epoch():
    """Of others, of another epoch, or of what is not known, nothing counts."""
    shares = lending()
    shares["b"].use(1.1, (300.0,))
    returned, (before,) = shares["b"].returned(1.2), shares["a"].lent(1.2)
    assert shares["a"].take_back("c", shares["a"].epoch, returned) == []
    assert shares["a"].take_back("b", 7, returned) == []
    assert shares["b"].take_back("a", shares["b"].epoch, returned) == []
    assert shares["a"].take_back("b", shares["a"].epoch, [replace(returned[0], begins=7)]) == []
    assert shares["a"].lent(1.3) == (before,)


def test_what_was_given_back_is_not_held_again_when_it_is_lengthened():
    """Who lends had not heard of it when it let us use it for longer."""
    shares = lending()
    shares["b"].use(1.1, (300.0,))
    shares["a"].lengthen(1.2, *shares["a"].lent(1.2), 3.0)
    tell(shares, "a", "b", 1.3)
    assert [shares["b"].held(t, 0) for t in (2.0, 2.2)] == pytest.approx([300.0, 0.0])


def test_who_has_a_slot_sends_nothing_larger_than_the_limit_beside_those_of_others():
    """A slot is not all that there is: such a message waits until nobody else may send."""
    shares = team("abc")
    agree(shares, 0.1)
    for peer in "bc":
        assert shares["a"].lend(0.1, peer, 0.2, 5.0, (300.0,)).stays
    tell(shares, "a", "bc", 0.2)
    assert shares["b"].stays(0.5)
    assert not shares["b"].fits(0.5, (1980.0,))
    assert not shares["a"].fits(0.5, (1980.0,))


def test_slots_are_not_given_back():
    """They are lengthened, or end."""
    shares = lending(ends=5.0)
    shares["b"].use(1.1, (300.0,))
    assert give_back(shares, 1.2)[0] == ()
    assert shares["b"].returned(5.1) == ()


def test_what_other_sends_still_need_is_not_given_back():
    """Two sends of 200 B need both times 300 B that are lent."""
    shares = team("ab")
    agree(shares, 0.1)
    for begins in (1.0, 1.01):
        shares["a"].lend(0.1, "b", begins, 1.5, (300.0,))
    tell(shares, "a", "b", 0.2)
    shares["b"].use(1.1, (400.0,))
    assert [each.used for each in shares["b"].returned(1.6)] == [1.1, 1.1]
    assert shares["b"].held(1.6, 0) == pytest.approx(600.0)


def test_slots_are_not_given_back_however_little_clocks_leave_of_them():
    """Who leads lengthens them, and could not if they were given back."""
    shares = team("ab")
    agree(shares, 0.1)
    shares["a"].lend(0.1, "b", 1.0, 1.1 + LONG, (300.0,))
    shares["b"].heard(0.2, "a", shares["a"].epoch, shares["a"].grants(0.2), uncertainty=0.5)
    assert shares["b"].fits(2.1, (300.0,))
    assert shares["b"].returned(4.0) == ()
    shares["a"].lend(0.3, "b", 1.0, 0.5 + LONG, (300.0,))
    shares["b"].heard(0.4, "a", shares["a"].epoch, shares["a"].grants(0.4), uncertainty=0.5)
    assert len(shares["b"].returned(4.0)) == 1


def test_what_is_lent_late_lasts_as_long_as_it_has_to():
    """Room that comes back shortly before the end is lent beyond it."""
    shares = team("ab")
    agree(shares, 0.1)
    first = shares["a"].lend(0.1, "b", 0.1, 1.0, (700.0,))
    second = shares["a"].lend(0.2, "b", 0.2, 2.1, (700.0,), lasting=LONG)
    assert second.begins > first.ends + LIMIT.window
    assert second.ends == pytest.approx(second.begins + LONG, abs=0.002)
    assert shares["a"].lend(0.2, "b", 0.2, 2.1, (700.0,), lasting=LONG) is None
