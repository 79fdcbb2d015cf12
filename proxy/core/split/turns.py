"""Turns: who of those that share a slot may use it.

A slot's turn has a number. The robot at that place of the ring holds the slot, and it alone makes the number greater.
A robot knows each number that it told itself. So two robots never hold a slot at once, however digests are lost, late
or repeated. What was sent in the slot stays in the window for a while: who passes the slot on tells how long it has
been unused.
"""

import math
from dataclasses import dataclass

from proxy.core.split.allocation import Slot

TURN = 15.0
"""A turn lasts at least so many times what news take: then passing slots on costs about a fifteenth of them."""

ROUND = 40.0
"""Where news take long, turns are so short that everyone's comes this often [s], if they are to last one window."""


@dataclass(slots=True)
class Turn:
    """Whose turn it is with a slot, as far as we know."""

    slot: Slot
    number: int = 0
    used: float = -math.inf
    """When the slot may last have been used, by us or by others [s]."""

    @property
    def holder(self) -> str:
        """Whose turn it is."""
        return self._at(self.number)[0]

    @property
    def giver(self) -> str:
        """Who passed the slot on to the one that holds it; nobody at the first turn."""
        return self._at(self.number - 1)[0] if self.number else ""

    def _at(self, number: int) -> tuple[str, int]:
        return self.slot.ring[number % len(self.slot.ring)]

    def heard(self, now: float, teller: str, number: int, unused: float) -> bool:
        """Take over a greater number; `unused`: for how long, says the one that passed the slot on [s]."""
        if number <= self.number:
            return False
        self.number = number
        self.used = now - unused if teller == self.giver else now
        return True

    def ends(self, window: float, news: float) -> float:
        """Return when the holder's turn ends [s]: some windows after it began, more where `news` take long [s]."""
        return self.used + window + self._at(self.number)[1] * self._windows(window, news) * window

    def _windows(self, window: float, news: float) -> int:
        """How many windows the shortest turn lasts."""
        enough = math.ceil(TURN * news / window - 1e-9)
        shares = sum(share for _, share in self.slot.ring)
        most = (ROUND - len(self.slot.ring) * (news + window)) / (shares * window)
        return max(1, min(enough, math.floor(most)))
