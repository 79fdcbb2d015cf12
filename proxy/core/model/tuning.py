"""The constants of this package."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ModelTuning:
    """What digests may use, from which size on samples concern everybody, and how far plans reach."""

    least_allowance: float = 100.0
    """What the digests of a team may use whatever the limit is, for each of its robots [B/s]."""
    least_left: float = 0.1
    """Part of a limit that digests leave to messages in any case."""
    least_digest: int = 64
    """A digest counts as at least this large [B], so that so many bytes are at most so many digests."""
    large: float = 0.02
    """What takes more than this part of a limit is announced at once when it is sent, as what was sent together is."""
    bulky: float = 0.5
    """For messages that take no more than this part of a limit no window is stretched."""
    planned_windows: float = 4.0
    """Plans reach this many of the longest window of a limit (93.5 % of the bound; with two sends of all 92.3)."""


TUNING = ModelTuning()
