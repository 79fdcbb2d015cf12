"""Turns: who of those that share a slot may use it, as with the token of a token ring.

A slot's turn has a number; the robot at that place of the ring holds the slot, and alone makes the number greater. So
two robots never hold a slot at once, however digests are lost. Who passes it on announces how long it has been unused.
"""

import math
from dataclasses import dataclass

from proxy.core.split.allocation import Slot
from proxy.core.split.tuning import TUNING


@dataclass(slots=True)
class Turn:
    """Whose turn it is with a slot, as far as one robot knows."""

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

    def begin(self, now: float) -> None:
        """All have agreed on the slot: what was sent before may have used its room, if nobody passed it on yet."""
        self.used = self.used if self.number else now

    def heard(self, now: float, sender: str, number: int, unused: float) -> bool:
        """Take over a greater number; `unused`: for how long, says the one that passed the slot on [s]."""
        if number <= self.number:
            return False
        self.number = number
        self.used = now - unused if sender == self.giver else now
        return True

    def pass_on(self) -> None:
        """It is the next one's turn."""
        self.number += 1

    def note_use(self, until: float) -> None:
        """The slot was used until then [s]."""
        self.used = max(self.used, until)

    def ends(self, window: float, news: float) -> float:
        """Return when the holder's turn ends [s]: some windows after it began, more where `news` take long [s]."""
        return self.used + window + self._at(self.number)[1] * self._windows(window, news) * window

    def shortest(self, window: float, news: float) -> float:
        """Return how long the shortest turn lasts, with the window until the next one may use the slot [s]."""
        return window + self._windows(window, news) * window

    def _windows(self, window: float, news: float) -> int:
        """How many windows the shortest turn lasts."""
        enough = math.ceil(TUNING.turn_news * news / window - 1e-9)
        shares = sum(share for _, share in self.slot.ring)
        most = (TUNING.round_time - len(self.slot.ring) * (news + window)) / (shares * window)
        return max(1, min(enough, math.floor(most)))
