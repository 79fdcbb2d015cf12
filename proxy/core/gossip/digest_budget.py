"""What robots may tell each other: one bucket of bytes for the whole team, and our part of what is for ordinary news.

Each robot takes what it tells and hears out of a bucket that fills at the whole rate, if need be ahead of time. A part
is for ordinary news, an equal one of each robot, which pay for states, questions and answers, too.
"""

import math
from collections import deque
from collections.abc import Iterable
from itertools import chain

from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import Echo
from utility_specs.digests import LEAST_RATE


class StateBudget:
    """Our part of the allowance for all that is no digest."""

    def __init__(self, rate: float) -> None:
        self._allowance, self._robots = rate, 1
        self._debt = -TUNING.state_savings * rate
        """What is not paid for yet; negative: what is saved [B]."""

    def set_rate(self, allowance: float, robots: int) -> None:
        """The allowance of so many robots is now this [B/s]."""
        self._allowance, self._robots = allowance, robots

    def gain(self, seconds: float) -> float:
        """So much time went by; return what was paid of debts meanwhile [B]."""
        before, self._debt = self._debt, max(self._debt - seconds * self._rate, -TUNING.state_savings * self._rate)
        return max(0.0, before) - max(0.0, self._debt)

    def owe(self, size: int, copies: int) -> None:
        """Something of so many bytes went out in so many copies. Who asks again and again silences nobody for long."""
        self._debt = min(self._debt + (size + TUNING.overhead) * copies, TUNING.deepest_state_debt * self._rate)

    @property
    def paid_in(self) -> float:
        """How long it takes from the last gain on until all is paid for [s]."""
        return max(0.0, self._debt) / self._rate

    def takes(self, size: int, copies: int) -> float:
        """Return for how long a state of so many bytes, in so many copies, takes what we may spend on states [s]."""
        return (size + TUNING.overhead) * copies / self._rate

    def question_takes(self) -> float:
        """Return for how long a question and its answer take the allowance, where all robots ask in turn [s]."""
        return (TUNING.question + TUNING.answer) * self._robots / self._allowance

    @property
    def _rate(self) -> float:
        return TUNING.states * self._allowance / self._robots


class EchoBudget:
    """Echoes in turn: of those robots first that were not echoed for longest."""

    def __init__(self) -> None:
        self._left = TUNING.echoes_ahead
        """What echoes may take now [B]."""
        self._window_holds = math.inf
        """What may be told in a window [B]: a digest takes no more for the sake of echoes, but for one."""
        self._echoed: dict[str, float] = {}
        """When each robot was echoed last [s]."""

    def gain(self, size: float, most: float) -> None:
        """The allowance brought so many bytes for ordinary news; echoes save their part of them, up to `most`."""
        self._left = min(max(most, TUNING.echoes_ahead), self._left + TUNING.echoes * size)

    def limit(self, window_holds: float) -> None:
        """So much may be told in a window [B]."""
        self._window_holds = window_holds

    def affords(self, copies: int) -> int:
        """Return how many echoes a digest of so many copies has room for."""
        return min(TUNING.echoed, int(self._left / (TUNING.echo * max(1, copies))))

    def take(self, now: float, echoes: Iterable[Echo], copies: int, size: int) -> tuple[Echo, ...]:
        """Return some of the echoes, for a digest of `size` bytes so far, in so many copies, that goes out now.

        Larger ones than a window has room for meet others there (*mixed*, eight robots, 1 % of the digests lost: 1.5 %
        of the windows over the limit without that, now 1.3).
        """
        known = {echo.peer: echo for echo in echoes}
        self._echoed = {peer: at for peer, at in self._echoed.items() if peer in known}
        due = [peer for peer in known if now >= self._echoed.get(peer, -math.inf) + TUNING.slowest_digest]
        left = self._window_holds / max(1, copies) - TUNING.overhead - size
        most = min(self.affords(copies), max(1, math.floor(min(left / TUNING.echo, TUNING.echoed))))
        chosen = sorted(due, key=lambda peer: self._echoed.get(peer, -math.inf))[:most]
        self._left -= TUNING.echo * copies * len(chosen)
        self._echoed.update(dict.fromkeys(chosen, now))
        return tuple(known[peer] for peer in chosen)


class RecentBytes:
    """Amounts [B] by when they were told [s], and the `total` of the window that ends now, which is not summed up."""

    def __init__(self) -> None:
        self.total = 0.0
        self._told: deque[tuple[float, float]] = deque()
        self._before: deque[tuple[float, float]] = deque()
        """What was told in the window before that."""

    def add(self, now: float, amount: float) -> None:
        """So much is told now."""
        self._told.append((now, amount))
        self.total += amount

    def advance(self, now: float, window: float) -> None:
        """A window of so long [s] ends now."""
        told, before = self._told, self._before
        while told and told[0][0] < now - window:
            self.total -= told[0][1]
            before.append(told.popleft())
        while before and before[0][0] < now - 2.0 * window:
            before.popleft()
        if not told:
            self.total = 0.0

    def fits_since(self, window: float, room: float) -> float:
        """Return since when, or from when on, a window holds no more than `room` of it [s]: what was too much left."""
        held, inside = 0.0, deque[tuple[float, float]]()
        for t, amount in chain(reversed(self._told), reversed(self._before)):
            held += amount
            inside.append((t, amount))
            while inside[0][0] > t + window:
                held -= inside.popleft()[1]
            if held > room:
                return t + window
        return -math.inf


GOLDEN = 0.618
"""Turns that move on by this part of a round are spread evenly, and two robots seldom have the same turn."""


def _beside_debts(told_at: float, turn: float, takes: float) -> float:
    """Return when is told what `takes` so long of the allowance, beside debts that are paid [s].

    Some time after anybody told anything, each robot another, by its `turn`.
    """
    return told_at + (1.0 / TUNING.parts_in_debt + turn) * takes


class DigestBudget:
    """Spends the allowance of this robot, at first what comes in `saved` [s]; each begins at another `turn`."""

    def __init__(self, now: float, turn: float = 0.0, saved: float = 0.0) -> None:
        self.states = StateBudget(LEAST_RATE)
        self.echoes = EchoBudget()
        self.rate = LEAST_RATE
        """The allowance of all robots together [B/s]."""
        self._robots, self._copies, self._follows = 1, 1, False
        self._saved, self._splits, self._quiet, self._window = saved, False, False, 0.0
        self._tight = False
        self._recent, self._recent_at = RecentBytes(), now
        """What all told in the last window, and when anybody told anything last [s]."""
        self._common = 0.0
        """What is left of the allowance of all [B]."""
        self._own = LEAST_RATE
        """What is left of our share for ordinary news [B]."""
        self._updated = now
        self._afforded = math.inf
        """Since when that pays for an ordinary digest [s]; infinite where it does not."""
        self._size, self._brief = 64.0, 48.0
        """What the last ordinary digest took, and the last other one [B]."""
        self.last_ordinary = now - TUNING.slowest_digest
        """When the last ordinary digest went out [s]."""
        self._told_at, self._told = now, 0.0
        """When we told anything last [s], and what that took [B]."""
        self._turn = turn
        """For an ordinary digest this part of a digest more has to be left of the allowance; it moves on with each."""

    def set_rate(self, rate: float, robots: int, copies: int, *, follows: bool = False) -> None:
        """The allowance of so many robots is now `rate` [B/s], all copies together; digests go in so many `copies`.

        `follows`: digests tell of a channel that limits follow, and have more of it beside announcements.
        """
        self._own += max(0, copies - self._copies) * self._size
        if self._saved:
            self._common += max(0.0, rate - self.rate) * self._saved
        self.rate, self._robots, self._copies, self._follows = rate, robots, copies, follows
        self.states.set_rate(rate, robots)

    def follow(
        self, now: float, *, splits: bool, quiet: bool, begins: bool, window: float, tight: bool = False
    ) -> None:
        """Each robot has its part or not, and the team `begins` or has done so; `window` is the shortest one [s].

        `tight`: announcements take most of the allowance.

        A large, `quiet` team tells ordinary news in turn: else five of fifty robots told them at once (1.16 limits).
        """
        if quiet and not self._quiet:
            self._own = min(self._own, -self._turn * self._size * self._copies)
        self._splits, self._quiet, self._window, self._tight = splits, quiet, window, tight
        self.advance(now)
        if self._saved and not begins:
            self._saved = 0.0
            self._common = min(self._common, 0.0 if splits else self._most)
            if splits:
                self._own = -self._turn * self._size * self._copies
        free = self._saved or self._follows or not window
        self.echoes.limit(math.inf if free else self.rate * window)

    def advance(self, now: float) -> None:
        """Take in what the allowance has brought since the last time."""
        self._recent.advance(now, self._window)
        elapsed = now - self._updated
        if elapsed > 0.0:
            self._common, self._own = self._levels(now)
            self._updated = now
            rate = self._own_rate(self._common)
            self.echoes.gain(elapsed * rate, self._most_own(rate))
            self._own -= self.states.gain(elapsed)
            self._afforded = min(self._afforded, now) if self._own >= self._size * self._copies else math.inf

    @property
    def told_lately(self) -> float:
        """What all told in the last window where announcements take most of the allowance, as of the last word [B]."""
        return self._recent.total if self._tight else 0.0

    def heard(self, now: float, size: int, copies: int) -> None:
        """Another robot told something of so many bytes, in so many copies."""
        cost = self._note(now, size, copies)
        self._common = max(self._common - cost, -TUNING.deepest_debt * self.rate)

    def sent(self, now: float, size: int, copies: int, *, announces: bool = False) -> None:
        """A digest of so many bytes went out in so many copies; `announces`: only what was sent."""
        cost = self._note(now, size, copies)
        self._common = max(self._common - cost, -TUNING.deepest_debt * self.rate)
        self._told_at, self._told = now, cost
        if announces:
            self._brief = float(size + TUNING.overhead)
            return
        self._size, self.last_ordinary = float(size + TUNING.overhead), now
        self._own -= cost
        self._afforded = math.inf
        self._turn = (self._turn + GOLDEN) % 1.0

    def due(self, now: float, *, apart: float, copies: int) -> float:
        """When the next digest may go out in so many copies, in our clock [s]; now or earlier means at once.

        Digests are so far `apart` at least [s]. For room beside what others tell we wait a second or two at most, one
        window at least where that is shorter: else two of eight told at one moment (1.1 % over). Where limits follow
        the channel nobody is silent for longer than its equal part takes to pay for a digest, whatever it owes: four
        robots behind 300 kbit/s owed their first digests for half a minute, and nobody knew how the channel was.
        """
        cost, slowest = self._size * copies, TUNING.slowest_digest
        common, own = self._levels(now)
        # Where all have waited for the allowance, they do not go on at the same moment.
        turn = 1.0 + self._turn
        # Who waits for room waits no less as others use up the allowance, nor for ever.
        affordable = min(self._afforded, now + (cost - own) / self._own_rate(common if own < cost else 0.0))
        room = now + max(0.0, cost * turn - common) / self.rate
        fits, patience = self._fits_at(now, cost), TUNING.unhurried if self._splits and not self._follows else slowest
        if self._follows:
            affordable = min(affordable, self.last_ordinary + max(slowest, cost / self._own_rate(-math.inf)))
        window = self._window if self._window < slowest else 0.0
        until = max(affordable + window * turn, self.last_ordinary + patience * turn)
        due = max(now, affordable, min(max(room, fits), until))
        if self._splits:
            due = max(due, min(fits, self._told_at + self._patience(cost)))
        return max(due, self.last_ordinary + apart)

    def due_ahead(self, now: float, seconds: float, *, announces: bool = False) -> float:
        """When a digest may go out that spends the allowance of so many seconds ahead of time, in our clock [s].

        One that `announces` may go the further ahead the longer we told nothing, in the end as far as all may owe. Each
        works out by itself what all owe: whoever finds it a little more than the others would always come too late for
        what the allowance brings. One of six robots was mute for 97 % of a flight by that (68 % of a central decider,
        81 so); another one, that heard two teams meet, for 28 s.
        """
        cost = self._brief * self._copies
        if announces:
            deeper = (TUNING.deepest_debt - seconds) / self._patience(cost)
            wait = -seconds - deeper * (now - self._told_at) - self._levels(now)[0] / self.rate
            return now + max(0.0, wait) / (1.0 + deeper)
        return max(now, min(self._paid_ahead(now, seconds), self._told_at + self._patience(cost) + TUNING.deepest_debt))

    def due_with_parts(self, now: float, seconds: float) -> float:
        """The same for news of parts, which a part of the allowance is left to while debts are paid [s]."""
        takes = self._brief * self._copies / self.rate
        return max(now, min(self.due_ahead(now, seconds), _beside_debts(self._recent_at, self._turn, takes)))

    def due_soon(self, now: float) -> float:
        """When urgent news may go that spends nothing ahead of time, nor what is saved for the beginning [s]."""
        return self._paid_ahead(now, -self._saved)

    def due_in_turn(self, now: float, since: float, seconds: float, copies: int) -> float:
        """When a digest may go out that spends so much ahead of time, if all robots have one since then [s].

        In turn: ten robots that answered a new bid at once had 9 % of the windows over the limit, and have none.
        """
        cost = self._brief * copies
        takes = self._robots * cost / self.rate
        turn = since + self._turn * TUNING.answers * takes if takes > self._window else now
        paid = min(
            self._paid_ahead(now, seconds * (1.0 - self._turn)),
            _beside_debts(self._recent_at, self._turn, cost / self.rate),
        )
        room = max(paid, self._fits_at(now, cost))
        return max(now, min(room, self._told_at + self._patience(cost)), turn)

    def _paid_ahead(self, now: float, seconds: float) -> float:
        """When no more than the allowance of so many seconds is spent ahead of time by all [s]."""
        return now + max(0.0, -seconds * self.rate - self._levels(now)[0]) / self.rate

    def _patience(self, cost: float) -> float:
        """How long after our last word we wait for the others to leave room at most [s]: an equal part pays for it.

        Else a robot that says fifty digests a second silences all others; what we told last is paid for first.
        """
        return TUNING.patience * max(cost, self._told) * self._robots / self.rate

    def _note(self, now: float, size: int, copies: int) -> float:
        """Return what so many bytes in so many copies cost; that much was told now."""
        self.advance(now)
        cost = (size + TUNING.overhead) * max(1, copies)
        self._recent.add(now, cost)
        self._recent_at = now
        return cost

    def _fits_at(self, now: float, cost: float) -> float:
        """When so much can be told that no window holds more than its allowance [s]; each robot a little apart.

        What alone takes nearly that, or more, goes beside little else.
        """
        if self._saved or not self._window:
            return now
        room = max(self.rate * self._window - cost, TUNING.beside * self.rate * self._window)
        return max(now, self._recent.fits_since(self._window, room) + self._turn * cost / self.rate)

    def _levels(self, now: float) -> tuple[float, float]:
        """What is left of the allowance of all, and of our part for ordinary news, as of now [B]."""
        elapsed = now - self._updated
        if elapsed <= 0.0:
            return self._common, self._own
        common = max(self._common, min(self._common + elapsed * self.rate, self._most))
        rate = self._own_rate(common)
        return common, min(self._most_own(rate), self._own + elapsed * rate)

    @property
    def _most(self) -> float:
        """So much may be saved of the allowance of all [B]; what is for the beginning comes back until that."""
        return max(TUNING.spare * self.rate, 2.0 * self._size * self._copies, self._saved * self.rate)

    def _own_rate(self, common: float) -> float:
        """Our share of what is for ordinary news [B/s]: that is all, as long as announcements leave it."""
        least = TUNING.ordinary_on_channel if self._follows else TUNING.ordinary
        return (least if common < 0.0 or self._splits else 1.0) * self.rate / self._robots

    def _most_own(self, rate: float) -> float:
        """So much may be saved for ordinary news [B]."""
        return max(3.0 * self._size * self._copies, rate)
