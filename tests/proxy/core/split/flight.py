"""Robots that split a limit: they come and go, and digests are lost, late, repeated and out of order."""

import random

from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.split.split import Split

WINDOW = 1.0
FLOOR = 0.02


def random_bid(rng):
    """Small streams, and large messages of some sizes."""
    small = [Segment(rng.randint(1, 2000), rng.randint(100, 160)) for _ in range(rng.randint(0, 2))]
    sizes = [rng.choice([rng.randint(300, 9500), 2000, 4200]) for _ in range(rng.randint(0, 2))]
    large = [Segment(size, rng.randint(90, 130), rng.choice([1, 1, 2, 4])) for size in sizes for _ in range(2)]
    return tuple(small + large)


def waits_for_turn(split):
    """Whether it shares slots of which none is its own now."""
    own, turns = split.agreement.own, split.agreement.turns
    shares = any(own in dict(turn.slot.ring) for turn in turns)
    return shares and all(turn.holder != own for turn in turns)


class Flight:
    """Some robots on one channel; `delay` is the longest that a digest takes [s]."""

    def __init__(
        self, seed, robots, *, loss=0.0, delay=0.2, pace=0.05, floor=FLOOR, bids=random_bid, rest=0.05, noticed=0.3
    ):
        self.rng, self.loss, self.delay, self.pace, self.floor = random.Random(seed), loss, delay, pace, floor
        self.bids, self.rest, self.noticed = bids, rest, noticed
        self.mute, self.kinds = set(), {}
        self.now, self.splits, self.groups, self.clocks, self.demand = 100.0, {}, {}, {}, {}
        self.mail, self.notices, self.sends, self.spoken, self.number = [], [], [], {}, 0
        self.heard = {}
        self.met = -1.0
        for i in range(robots):
            self.join(f"r{i}")

    def clock(self, name):
        return self.now + self.clocks[name]

    def together(self, name):
        return {other for other in self.splits if self.groups[other] == self.groups[name]}

    def join(self, name, group=0):
        self.groups[name], self.clocks[name] = group, self.rng.uniform(-50.0, 50.0)
        now = self.clock(name)
        kind = self.kinds.get(name, b"")
        self.splits[name] = Split(name, now, (WINDOW,), floor=self.floor, settled_at=now + 1.0, kind=kind)
        self.spoken[name], self.demand[name] = -1.0, self.bids(self.rng)
        self.splits[name].bid(now, self.demand[name])
        self.notice_in(self.noticed)

    def notice_in(self, most):
        for name in self.splits:
            self.notices.append((self.now + self.rng.uniform(0.0, most), name))

    def leave(self, name):
        self.sends = [(t, use, by, self.groups.get(by, group)) for t, use, by, group in self.sends]
        del self.splits[name], self.groups[name]
        self.notice_in(self.rng.choice([0.3, 2.0]))

    def regroup(self, groups):
        """Teams part or meet: group by name."""
        if any(self.groups[a] != self.groups[b] and groups[a] == groups[b] for a in self.splits for b in self.splits):
            self.met = self.now + self.noticed + WINDOW
        self.sends = [send for send in self.sends if send[2] in self.splits]
        self.groups |= groups
        self.notice_in(self.noticed)

    def notice(self):
        for _, name in [notice for notice in self.notices if notice[0] <= self.now]:
            if name in self.splits:
                self.splits[name].set_members(self.clock(name), self.together(name))
        self.notices = [notice for notice in self.notices if notice[0] > self.now]

    def notice_all(self):
        self.notices = [(self.now, name) for name in self.splits]
        self.notice()

    def speak(self, name):
        self.spoken[name] = self.now
        if self.splits[name].agreement.silent:
            return
        told, self.number = self.splits[name].announcement(self.clock(name)), self.number + 1
        self.splits[name].announced(self.clock(name), told)
        for to in self.splits:
            for _ in range(self.rng.choice([1, 1, 2])):
                if to != name and name not in self.mute and self.rng.random() >= self.loss:
                    late = self.delay * self.rng.uniform(0.5, 1.0)
                    self.mail.append((self.now + late, self.number, to, name, told))

    def hear(self):
        due = [letter for letter in self.mail if letter[0] <= self.now]
        self.mail = [letter for letter in self.mail if letter[0] > self.now]
        for _, number, to, by, told in due:
            together = to in self.splits and self.groups[to] == self.groups.get(by)
            # Late digests are left out, what comes in a state is not.
            if together and (number % 2 or number > self.heard.get((to, by), 0)):
                self.heard[to, by] = max(number, self.heard.get((to, by), 0))
                self.splits[to].heard(self.clock(to), by, told)

    def room(self, name):
        """What a robot may send now, as a part of the limit: its part less all that it sent in the window."""
        recent = sum(use for t, use, by, _ in self.sends if by == name and t > self.now - WINDOW)
        room = self.splits[name].own_part.of(self.clock(name)) - recent
        assert room <= self.splits[name].own_part.free(self.clock(name)) + 1e-6
        return room

    def in_transit(self):
        """Slots that were passed on and not yet taken [units]."""
        slots = [turn.slot for split in self.splits.values() for turn in split.agreement.turns]
        return max((sum(slot.size for slot in slots) // len(self.splits), 0)) if slots else 0

    def send(self, name, use):
        split, now = self.splits[name], self.clock(name)
        split.sent(now, (use,), max(1.0, use / max(split.own_part.of(now), 1.0 / UNIT)))
        self.sends.append((self.now, use, name, self.groups[name]))

    def act(self, name):
        """Send all that fits, a bit, or nothing."""
        room = self.room(name)
        use = self.rng.choice([room, room * self.rng.random(), 0.001])
        if 0.0 < use <= room:
            self.send(name, use)

    def exchange(self):
        """Robots notice each other, hear and speak, and bid."""
        self.notice()
        self.hear()
        for name, split in self.splits.items():
            if split.advance(self.clock(name), self.delay) or self.spoken[name] < self.now - self.pace:
                self.speak(name)
            split.bid(self.clock(name), self.demand[name])

    def step(self, longest=0.05):
        """A moment passes, and one robot does what it may."""
        self.now += self.rng.random() * longest
        self.exchange()
        name = self.rng.choice(list(self.splits))
        if self.rng.random() < self.rest:
            self.demand[name] = self.bids(self.rng)
        self.act(name)

    def happen(self, number, seldom=200):
        """Now and then a robot comes or goes, a team parts, or teams meet."""
        match self.rng.randrange(seldom):
            case 0 if len(self.splits) < 7:
                self.join(f"n{number}", self.rng.choice(list(self.groups.values())))
            case 1 if len(self.splits) > 1:
                self.leave(self.rng.choice(list(self.splits)))
            case 2:
                self.regroup({name: 2 * group + self.rng.randint(0, 1) for name, group in self.groups.items()})
            case 3:
                self.regroup({name: group // 2 for name, group in self.groups.items()})

    def union(self):
        """What the robots of one team sent in the last window, that of the team that sent most."""
        self.sends = [send for send in self.sends if send[0] > self.now - WINDOW]
        sums = {}
        for _, use, name, group in self.sends:
            now_in = self.groups.get(name, group)
            sums[now_in] = sums.get(now_in, 0.0) + use
        return max(sums.values(), default=0.0)
