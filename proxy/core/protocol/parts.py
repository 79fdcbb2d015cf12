"""What a digest says of the split, and as fields of a message."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from proxy.core.protocol.bid import Bid, packed, unpacked

TICK = 0.01
"""Times are told in whole ticks [s], rounded down: less room is then taken sooner, never later."""
MOST_TURNS = 64
MOST_TICKS = 100_000
MOST_ASKED = 64
"""Of so many robots of a team one can ask again."""
_TOP = 2**32 - 1
_USUAL: list[Any] = [None, None, -1, None, [], 0, 0]
"""What is left out at the end."""


@dataclass(frozen=True, slots=True)
class Told:
    """What a robot's digest says of the split."""

    version: int
    bid: Bid | None
    """None where all who take part know it."""
    table: int
    """The name of the sender's newest table."""
    agreed: int
    """The name of the last table that it agreed on; 0: none yet."""
    turns: tuple[int, ...] = ()
    """Turn numbers of the slots of that table."""
    unused: float = 0.0
    """For how long no slot was used that the sender passed on [s]."""
    missing: int = 0
    """Whom the sender asks to tell again: a bit for each member of the team by the order of tags, the least first."""


def fields(told: Told) -> list[Any]:
    """Return what is told as numbers, bytes and lists; what is empty at the end is left out."""
    agreed = -1 if told.agreed == told.table else told.agreed
    ticks = min(MOST_TICKS, max(0, int(told.unused / TICK + 1e-6))) if told.turns else 0
    bid = None if told.bid is None else packed(told.bid)
    everything = [told.version, told.table, agreed, bid, list(told.turns), ticks, told.missing]
    while everything[-1] == _USUAL[len(everything) - 1]:
        everything.pop()
    return everything


def told_of(told: Sequence[Any]) -> Told:
    """Return what such fields tell; raise `ValueError` where they are none. More of them are of a later version."""
    everything: list[Any] = [*told[: len(_USUAL)], *_USUAL[len(told) :]]
    version, table, agreed, bid, turns, ticks, missing = everything
    if not (_whole(version, 0, _TOP) and _whole(table, 1, _TOP) and _whole(agreed, -1, _TOP)):
        raise ValueError("no version or no name of a table")
    if not (isinstance(turns, list) and len(turns) <= MOST_TURNS and all(_whole(turn, 0, _TOP) for turn in turns)):
        raise ValueError("no turn numbers")
    if not (_whole(ticks, 0, MOST_TICKS) and isinstance(bid, bytes | None)):
        raise ValueError("no time or no bid")
    if not _whole(missing, 0, 2**MOST_ASKED - 1):
        raise ValueError("no members")
    known = None if bid is None else unpacked(bid)
    return Told(version, known, table, table if agreed == -1 else agreed, tuple(turns), ticks * TICK, missing)


def _whole(value: object, least: int, most: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and least <= value <= most
