"""The generation times of a stream that were seen, and the gaps between them."""

import math
from collections import deque

from proxy.core.forecast.rhythm import Numbered
from proxy.core.forecast.tuning import TUNING


class History:
    """The recent past of one stream."""

    def __init__(self) -> None:
        self.past: deque[Numbered] = deque(maxlen=TUNING.memory)
        self.first: Numbered | None = None
        """The first sample that was ever seen."""
        self.seen = 0
        """Samples seen in all."""
        self.numbered = True
        """Whether samples come with their numbers; if not, some may have been lost between them."""
        self.longest_gap = 0.0
        """The longest gap that was no pause, which shrinks with time [s]."""
        self.pauses = 0
        """So many of the last gaps in a row were pauses."""
        self._resumed = -TUNING.memory

    @property
    def newest(self) -> Numbered:
        """The last sample seen; one before all others while there is none."""
        return self.past[-1] if self.past else (0, -math.inf)

    @property
    def resumed(self) -> bool:
        """Whether the last pause is part of the recent past."""
        return self.seen - self._resumed < TUNING.memory

    def note(self, sample: Numbered, *, paused: bool) -> None:
        """A sample comes after the last one, perhaps after a pause."""
        if self.past and not paused:
            self.longest_gap = max(sample[1] - self.past[-1][1], TUNING.gap_fade * self.longest_gap)
        self.first = self.first or sample
        self.past.append(sample)
        self.seen += 1

    def set_numbered(self, *, numbered: bool) -> bool:
        """Samples come with numbers from now on, or without; return whether that is new."""
        changes, self.numbered = numbered != self.numbered, numbered
        return changes

    def note_gap(self, *, paused: bool) -> None:
        """The gap before the sample that is noted next was a pause, or none."""
        self.pauses = self.pauses + 1 if paused else 0
        if paused:
            self._resumed = self.seen

    def keep(self, last: int) -> None:
        """Forget all but so many of the last samples."""
        self.past = deque(list(self.past)[-last:] if last else [], maxlen=TUNING.memory)

    def forget_since(self, t: float) -> None:
        """Forget what was generated at this time or later."""
        self.past = deque([each for each in self.past if each[1] < t], maxlen=TUNING.memory)

    def restart(self) -> None:
        """Forget all times."""
        self.past.clear()
        self.first, self.longest_gap = None, 0.0
