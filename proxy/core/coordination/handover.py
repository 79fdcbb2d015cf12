"""Whose turn it is for room that a send leaves: its robot's first, then the next one's by name, and so on round.

Where all took such room at the moment it opened 16 to 78 % of the windows of 6 to 12 robots were over the limit, and 5
to 10 are now, with 94 to 100 % of a central decider's utility (broadcast, 30 s).
"""

from proxy.core.coordination.claims import news_take
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, Send, shortest_window
from proxy.core.view.view import SharedView


class Handover:
    """How much later than it opens room is ours that others leave."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._known: tuple[tuple[Send, ...], tuple[Send, ...]] = (), ()
        """What others had sent, and the same as its room comes to us."""

    def longest(self, robots: int, limits: tuple[Limit, ...]) -> float:
        """Return the longest time until it is ours where so many other robots take turns [s]."""
        return min(robots * self._step(), TUNING.handed_part * shortest_window(limits))

    def in_turn(self, sends: tuple[Send, ...], since: float, limits: tuple[Limit, ...]) -> tuple[Send, ...]:
        """Return what others sent since then [s], each as much later as its room comes to us."""
        if sends is not self._known[0]:
            senders = [robot for *_, robot in self._view.traffic.sent_since(since)]
            own, others = self._view.traffic.robot, set(senders)
            names = sorted(others | {own})
            place, step, longest = names.index(own), self._step(), self.longest(len(others), limits)
            after = {robot: min((place - k) % len(names) * step, longest) for k, robot in enumerate(names)}
            late = [(t + after[robot], use) for (t, use), robot in zip(sends, senders, strict=True)]
            self._known = sends, tuple(late)
        return self._known[1]

    def _step(self) -> float:
        """Return how much later the next robot takes room: it would have heard of who took it before [s]."""
        return TUNING.handed_news * news_take(self._view)
