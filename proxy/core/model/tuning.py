"""The constants of this package."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ModelTuning:
    """From which size on samples concern everybody, and how far plans reach."""

    large: float = 0.02
    """What takes more than this part of a limit is announced at once when it is sent, as what was sent together is."""
    bulky: float = 0.5
    """For messages that take no more than this part of a limit no window is stretched."""
    planned_windows: float = 4.0
    """Plans reach this many of the longest window of a limit (93.5 % of the bound; with two sends of all 92.3)."""


TUNING = ModelTuning()
