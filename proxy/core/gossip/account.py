"""What robots tell each other, booked twice: against the allowance, and beyond that against the limits.

The limits leave the allowance to digests. It may be spent ahead of time (`digest_budget.py`): then a window holds more
digests than the limits leave room for, and the rest counts against the limits like samples.

What robots tell each other beyond what the limits leave to it, so that it counts like samples.

The allowance may be spent ahead of time: then a window holds more digests than the limits leave out. Ten robots with
five messages to a window exceeded the limit in 9 to 20 % of their windows where that did not count, in unicast at 20
and 100 ms, and in 0 to 13 % where it does (one seed).
"""

import math

from proxy.core.coordination.budget import Budget
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.recent_bytes import RecentBytes
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import allowance_of, shortest_window
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, State
from proxy.core.view.view import SharedView


class Excess:
    """What was told within a window, and which part of it was more than may be; each part counts for a whole window."""

    def __init__(self) -> None:
        self._said, self._over = RecentBytes(), RecentBytes()

    def note(self, now: float, size: float, window: float, allowed: float) -> float:
        """Return how much of these bytes is more than is allowed in the window that ends now [B]."""
        self._said.forget(now - window)
        self._over.forget(now - window)
        self._said.add(now, size)
        over = max(0.0, min(size, self._said.total - allowed - self._over.total))
        if over > 0.0:
            self._over.add(now, over)
        return over


class Account:
    """Books what this robot tells and what it hears others tell. `limits` are those in force."""

    def __init__(self, view: SharedView, limits: Budget, budget: DigestBudget) -> None:
        self._view = view
        self._limits = limits
        self._budget = budget
        self._excess = Excess()
        self._allowance = MODEL.least_allowance
        """What all robots may tell each other [B/s]."""
        self.told, self.heard = 0, 0
        """What this robot and the others told since the start, copies and overhead included [B]."""
        self._uncounted = 0.0
        """What was told beyond the allowance and is not counted yet; negative: what was counted ahead [B]."""

    def set_rate(self, part: float, *, follows: bool) -> None:
        """Set the rate for the team as it is. This `part` of the allowance is left; limits may follow the channel."""
        robots = len(self._view.peers) + 1
        self._allowance = allowance_of(self._view.specs, self._view.settings.allowance * part, robots)
        copies = 1 if self._view.settings.digests_on_air else robots
        rate = (1.0 if follows else TUNING.digests) * self._allowance
        self._budget.set_rate(rate, robots, copies, follows=follows)

    def described(self) -> dict[str, float]:
        """Return what the status says: the allowance of all robots [B/s], and what this one and others told [B]."""
        return {"allowance": self._allowance, "told": self.told, "heard": self.heard}

    @property
    def window(self) -> float:
        """The shortest window of what robots share [s]; none where they share nothing."""
        shortest = shortest_window(self._limits.limits)
        return 0.0 if math.isinf(shortest) else shortest

    @property
    def digest_copies(self) -> int:
        """How often a digest for all is transmitted."""
        return 1 if self._view.settings.digests_on_air and self._view.peers else self.copies

    @property
    def copies(self) -> int:
        """How often a state for all is transmitted."""
        return len(self._view.peers) + (self._view.settings.relayed and bool(self._view.peers))

    def heard_digest(self, now: float, size: int) -> None:
        """A digest of another robot, of so many bytes, came; those that were lost are booked with it."""
        sent, copies = round(size / (1.0 - self._view.paths.mean_loss())), self.digest_copies
        self._budget.heard(now, sent, copies)
        self.heard += self._count(now, sent, copies)

    def heard_state(self, now: float, state: State, size: int) -> None:
        """A state of another robot, of so many bytes, came: an update went to all, a whole state mostly to us alone."""
        copies = self.copies if state.since else 1
        if state.since and state.split is not None:
            self._budget.heard(now, size, copies)
        self.heard += self._count(now, size, copies)

    def sent_digest(self, now: float, digest: Digest, *, announces: bool) -> None:
        """A digest of ours goes out. Where it is broadcast it carries its whole key, else a number for the key."""
        on_air = self._view.settings.digests_on_air
        key = TUNING.on_air + len(self._view.settings.robot) if on_air else 0
        size, copies = len(pack_digest(digest)) + key, self.digest_copies
        self._budget.sent(now, size, copies, announces=announces)
        self.told += self._count(now, size, copies)

    def sent_parts(self, now: float, size: int) -> None:
        """An update of our state, of so many bytes, tells all of parts: that is paid for as digests are."""
        self._budget.sent(now, size, self.copies, announces=True)
        self.told += self._count(now, size, self.copies)

    def sent_other(self, now: float, size: int, copies: int) -> None:
        """A state or a question of ours, of so many bytes, goes out in so many copies."""
        self._budget.advance(now)
        self._budget.states.owe(size, copies)
        self.told += self._count(now, size, copies)

    def _count(self, now: float, size: int, copies: int) -> int:
        """Count what is told against the limits, as far as it is more than they leave to digests; return all of it."""
        told = (size + TUNING.overhead) * max(1, copies)
        if window := self.window:
            self._uncounted += self._excess.note(now, told, window, self._allowance * window)
            if self._uncounted > 0.0:  # ahead of what follows: where limits are of messages, each note is one
                ahead = max(self._uncounted, MODEL.least_digest)
                self._view.traffic.note_talk(now, math.ceil(ahead))
                self._uncounted -= ahead
        return told
