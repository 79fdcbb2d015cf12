"""What robots tell each other, booked against the allowance, which the limits leave to it."""

import math

from proxy.core.coordination.budget import Budget
from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import allowance_of, shortest_window
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, State
from proxy.core.view.view import SharedView
from utility_specs.digests import LEAST_RATE


class Account:
    """Books what this robot tells and what it hears others tell. `limits` are those in force."""

    def __init__(self, view: SharedView, limits: Budget, budget: DigestBudget) -> None:
        self._view = view
        self._limits = limits
        self._budget = budget
        self._allowance = LEAST_RATE
        """What all robots may tell each other [B/s]."""
        self.told, self.heard = 0, 0
        """What this robot and the others told since the start, copies and overhead included [B]."""

    def set_rate(self, part: float, *, follows: bool) -> None:
        """Set the rate for the team as it is. This `part` of the allowance is left; limits may follow the channel."""
        robots = self._view.members.speaking + 1
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
        return 1 if self._view.settings.digests_on_air and self._view.members.speaking else self.copies

    @property
    def copies(self) -> int:
        """How often a state for all is transmitted."""
        others = self._view.members.speaking
        return others + (self._view.settings.relayed and bool(others))

    def heard_digest(self, now: float, size: int) -> None:
        """A digest of another robot, of so many bytes, came; those that were lost are booked with it."""
        sent, copies = round(size / (1.0 - self._view.paths.mean_loss())), self.digest_copies
        self._budget.heard(now, sent, copies)
        self.heard += self._count(now, sent, copies)

    def paid_at(self, now: float) -> float:
        """When the allowance has paid for what all told so far [s]; now if it has."""
        return self._budget.due_ahead(now, 0.0)

    def heard_state(self, now: float, state: State, size: int) -> None:
        """A state of another robot, of so many bytes, came: an update went to all, a whole state mostly to us alone."""
        copies = self.copies if state.since else 1
        if state.since and state.split is not None:
            self._budget.heard(now, size, copies)
            self.heard += self._count(now, size, copies)
        else:
            self.heard += _cost(size, copies)

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
        self.told += _cost(size, copies)

    def _count(self, now: float, size: int, copies: int) -> int:
        """Return what something takes in so many copies [B]: load, while a window holds more than a tight allowance.

        Else 10 % of the windows of twelve robots that announced large samples ahead of it were over the limit. All that
        is told then counts, not just the excess. Where it is not tight eight robots with cameras sent 4 % less so.
        """
        cost, window = _cost(size, copies), self.window
        more = min(cost, round(self._budget.told_lately - self._allowance * window))
        if window and more > 0:
            self._view.traffic.note_words(now, math.ceil(more / max(1, copies)), max(1, copies))
        return cost


def _cost(size: int, copies: int) -> int:
    """Return what so many bytes take in so many copies [B]."""
    return (size + TUNING.overhead) * max(1, copies)
