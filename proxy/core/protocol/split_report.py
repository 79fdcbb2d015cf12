"""What a digest says of the split, and as fields of a message."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from proxy.core.protocol.bid import Bid, packed, unpacked
from proxy.core.protocol.tuning import TUNING

TICK = 0.01
"""Times are told in whole ticks [s], rounded down: less room is then taken sooner, never later."""
_TOP = 2**32 - 1
_USUAL: list[Any] = [None, None, -1, None, [], 0, 0]
"""What is left out at the end."""


@dataclass(frozen=True, slots=True)
class SplitReport:
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
    """Which robots the sender asks for their reports: a bit for each member of the team in the order of tags."""


def report_fields(report: SplitReport) -> list[Any]:
    """Return a report as numbers, bytes and lists; what is as usual at the end is left out."""
    agreed = -1 if report.agreed == report.table else report.agreed
    ticks = min(TUNING.unused_ticks, max(0, int(report.unused / TICK + 1e-6))) if report.turns else 0
    bid = None if report.bid is None else packed(report.bid)
    fields = [report.version, report.table, agreed, bid, list(report.turns), ticks, report.missing]
    while fields[-1] == _USUAL[len(fields) - 1]:
        fields.pop()
    return fields


def read_report(fields: Sequence[Any]) -> SplitReport:
    """Return the report in such fields, of which later versions may have more; raise `ValueError` where it is none."""
    version, table, agreed, bid, turns, ticks, missing = [*fields[: len(_USUAL)], *_USUAL[len(fields) :]]
    if not (_whole(version, 0, _TOP) and _whole(table, 1, _TOP) and _whole(agreed, -1, _TOP)):
        raise ValueError("no version or no name of a table")
    if not (isinstance(turns, list) and len(turns) <= TUNING.turns and all(_whole(turn, 0, _TOP) for turn in turns)):
        raise ValueError("no turn numbers")
    if not (_whole(ticks, 0, TUNING.unused_ticks) and isinstance(bid, bytes | None)):
        raise ValueError("no time or no bid")
    if not _whole(missing, 0, 2**TUNING.askable - 1):
        raise ValueError("no members")
    known = None if bid is None else unpacked(bid)
    return SplitReport(version, known, table, table if agreed == -1 else agreed, tuple(turns), ticks * TICK, missing)


def _whole(value: object, least: int, most: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and least <= value <= most
