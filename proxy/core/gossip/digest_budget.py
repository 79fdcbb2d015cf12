"""What robots may tell each other: one bucket of bytes for the whole team, and our part of what is for ordinary news.

Each robot keeps a bucket for the whole team: it fills at the whole rate, and the robot takes out what it tells and what
it hears. So the robots with most to announce announce most, if need be ahead of time. A part of the allowance is for
all else, and each robot has an equal share of it: for ordinary news, and for states, questions and answers, which are
paid for later.
"""

from proxy.core.gossip.echo_budget import EchoBudget
from proxy.core.gossip.recent_bytes import RecentBytes
from proxy.core.gossip.state_budget import StateBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.tuning import TUNING as MODEL

GOLDEN = 0.618
"""Turns that move on by this part of a round are spread evenly, and two robots seldom have the same turn."""


class DigestBudget:
    """Spends the allowance of this robot. Each robot begins with another `turn`, between 0 and 1.

    At first there is what the allowance brings in `saved` [s]. `advance` takes in what it has brought by now.
    """

    def __init__(self, now: float, turn: float = 0.0, saved: float = 0.0) -> None:
        self.states = StateBudget(MODEL.least_allowance)
        self.echoes = EchoBudget()
        self.rate = MODEL.least_allowance
        """The allowance of all robots together [B/s]."""
        self._robots, self._copies, self._follows = 1, 1, False
        self._saved, self._splits, self._quiet, self._window = saved, False, False, 0.0
        self._recent = RecentBytes()
        """What all told in the last window."""
        self._common = 0.0
        """What is left of the allowance of all [B]."""
        self._own = MODEL.least_allowance
        """What is left of our share for ordinary news [B]."""
        self._updated = now
        self._size, self._brief = 64.0, 48.0
        """What the last ordinary digest took, and the last other one [B]."""
        self.last_ordinary = now - TUNING.slowest_digest
        """When the last ordinary digest went out [s]."""
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

    def follow(self, now: float, *, splits: bool, quiet: bool, begins: bool, window: float) -> None:
        """Each robot has its part or not, and the team `begins` or has done so; `window` is the shortest one [s].

        Where each has its part nobody plans with ordinary news. A large, `quiet` team then tells them in turn: without
        turns five of fifty robots told them within 15 ms, and some windows held 1.16 limits. Once a team has begun, it
        does not need what was saved for the first agreement any more, and ordinary news go on, each robot in its turn.
        """
        if quiet and not self._quiet:
            self._own = min(self._own, -self._turn * self._size * self._copies)
        self._splits, self._quiet, self._window = splits, quiet, window
        self.advance(now)
        if self._saved and not begins:
            self._saved, self._common = 0.0, min(self._common, 0.0 if splits else self._most)
            if splits:
                self._own = -self._turn * self._size * self._copies

    def advance(self, now: float) -> None:
        """Take in what the allowance has brought since the last time."""
        self._recent.forget(now - self._window)
        elapsed = now - self._updated
        if elapsed > 0.0:
            self._common, self._own = self._levels(now)
            self._updated = now
            rate = self._own_rate(self._common)
            self.echoes.gain(elapsed * rate, self._most_own(rate))
            self.states.gain(elapsed)

    def heard(self, now: float, size: int, copies: int) -> None:
        """Another robot told something of so many bytes, in so many copies."""
        cost = self._note(now, size, copies)
        self._common = max(self._common - cost, -TUNING.deepest_debt * self.rate)

    def sent(self, now: float, size: int, copies: int, *, announces: bool = False) -> None:
        """A digest of so many bytes went out in so many copies; `announces`: only what was sent."""
        cost = self._note(now, size, copies)
        self._common -= cost
        if announces:
            self._brief = float(size + TUNING.overhead)
            return
        self._size, self.last_ordinary = float(size + TUNING.overhead), now
        self._own -= cost
        self._turn = (self._turn + GOLDEN) % 1.0

    def due(self, now: float, *, news: bool, copies: int, apart_at_least: float = 0.0) -> float:
        """When the next digest may go out in so many copies, in our clock [s]; now or earlier means at once.

        The digest is taken to be as large as the last one, and we tell no more than an equal part. We wait for room
        beside what others tell for a second or two at most, and for one window at least where windows are shorter: each
        of eight robots with cameras tells something every ten seconds, and where two did so at one moment 1.1 % of the
        windows were over the limit.
        """
        cost, slowest = self._size * copies, TUNING.slowest_digest
        common, own = self._levels(now)
        # Where all have waited for the allowance, they do not go on at the same moment.
        apart = 1.0 + self._turn
        affordable = now + (cost - own) / self._own_rate(common)
        room = now + max(0.0, cost * apart - common) / self.rate
        fits, patience = self._fits_at(now, cost), TUNING.unhurried if self._splits and not self._follows else slowest
        window = self._window if self._window < slowest else 0.0
        until = max(affordable + window * apart, self.last_ordinary + patience * apart)
        due = max(now, affordable, min(max(room, fits), until))
        if self._splits:
            due = max(due, fits)
        return max(due, self.last_ordinary + (apart_at_least if news else slowest))

    def due_ahead(self, now: float, seconds: float) -> float:
        """When a digest may go out that spends the allowance of so many seconds ahead of time, in our clock [s]."""
        return now + max(0.0, -seconds * self.rate - self._levels(now)[0]) / self.rate

    def due_in_turn(self, now: float, since: float, seconds: float, copies: int) -> float:
        """When a digest may go out that spends so much ahead of time, if all robots have one since then [s].

        Robots take turns, so that their digests do not come at one moment. Where all digests together take more than
        the allowance of a window, they are spread over the time that it takes to pay for them: when ten robots answered
        a new bid at once, up to 9 % of the windows were over the limit, by up to 0.23, though each robot kept its part;
        now none is.
        """
        takes = self._robots * self._brief * copies / self.rate
        turn = since + self._turn * TUNING.answers * takes if takes > self._window else now
        ahead = self.due_ahead(now, seconds * (1.0 - self._turn))
        return max(ahead, self._fits_at(now, self._size * copies), turn)

    def _note(self, now: float, size: int, copies: int) -> float:
        """Return what so many bytes in so many copies cost; that much was told now."""
        self.advance(now)
        cost = (size + TUNING.overhead) * max(1, copies)
        self._recent.add(now, cost)
        return cost

    def _fits_at(self, now: float, cost: float) -> float:
        """When so much can be told that no window holds more than its allowance [s].

        The limits leave no more than that to digests. Robots that wait for the same moment speak a little apart.
        """
        if self._saved:
            return now
        at = self._recent.fits_at(now, self._window, self.rate * self._window - cost)
        return at + self._turn * cost / self.rate if at > now else now

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
        """So much may be saved of the allowance of all [B]."""
        return max(TUNING.spare * self.rate, 2.0 * self._size * self._copies)

    def _own_rate(self, common: float) -> float:
        """Our share of what is for ordinary news [B/s]: that is all, as long as announcements leave it."""
        least = TUNING.ordinary_on_channel if self._follows else TUNING.ordinary
        return (least if common < 0.0 or self._splits else 1.0) * self.rate / self._robots

    def _most_own(self, rate: float) -> float:
        """So much may be saved for ordinary news [B]."""
        return max(3.0 * self._size * self._copies, rate)
