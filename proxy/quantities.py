"""Quantities and tables as text for people."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

Status = Mapping[str, Any]
Row = Sequence[str]

UNKNOWN = "-"

_LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
_SMALL = ((1.0, ""), (1e-3, "m"), (1e-6, "μ"))
_PREFIXES = {"s": _SMALL, "J": _SMALL, "messages": ()}


def columns(rows: Sequence[Row], alignment: str) -> list[str]:
    """Align columns, "l" left and "r" right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if side == "l" else cell.rjust(width)
            for cell, width, side in zip(row, widths, alignment, strict=True)
        ).rstrip()
        for row in rows
    ]


def duration(seconds: float | None) -> str:
    """Write a time [s] with a unit that suits it."""
    if seconds is None or not math.isfinite(seconds):
        return UNKNOWN
    if abs(seconds) < 1.0:
        return f"{seconds * 1e3:.3g} ms"
    if abs(seconds) < 60.0:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(abs(seconds)), 60)
    sign = "-" if seconds < 0.0 else ""
    return f"{sign}{minutes} min {rest} s" if minutes < 60 else f"{sign}{minutes // 60} h {minutes % 60} min"


def number(value: float | None) -> str:
    """Write a number with three digits."""
    return UNKNOWN if value is None else f"{value:.3g}"


def amount(value: float | None, unit: str) -> str:
    """Write a quantity with three digits and a decimal prefix; times and energies have small ones, counts none."""
    if value is None:
        return UNKNOWN
    for factor, prefix in _PREFIXES.get(unit, _LARGE):
        if abs(value) >= factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}"


def share(part: float | None, whole: float | None) -> str:
    """Write a part of a whole in percent."""
    return f"{part / whole:.0%}" if part is not None and whole else UNKNOWN


def schedule(stream: Status) -> str:
    """Write how a stream generates, and how exactly it keeps to that; or that no more is expected of it."""
    if stream.get("over"):
        return "over"
    kind, *rest = str(stream.get("schedule") or UNKNOWN).split()
    if kind == "bursts" and rest:
        return f"bursts of {rest[0]}"
    jitter, period = stream.get("jitter"), stream.get("period")
    return f"{kind} ±{share(jitter, period)}" if kind == "periodic" and jitter is not None and period else kind


def rate(stream: Status) -> str:
    """Write how many samples of a stream were sent per second, as far as its period is known."""
    period, generated = stream.get("period"), stream.get("generated", 0)
    if stream.get("over"):
        return "0"
    return f"{stream.get('forwarded', 0) / generated / period:.2g}" if period and generated else UNKNOWN
