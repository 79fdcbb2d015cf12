"""The report of a replay as text."""

from collections.abc import Sequence
from typing import Any

from proxy.printable import clean

Report = dict[str, Any]
HEAD = ("type", "messages", "sent", "bytes", "age", "95 %", "utility", "of all", "bound")
EXPLAINED = "of all: of the utility if all samples went; bound: of that of the offline bound"
MOST_DIFFERENCES = 12
"""Lines that say what fared otherwise."""


def table(report: Report) -> str:
    """Return the report as it is printed."""
    types = report["types"]
    rows = [HEAD, *(_row(name, figures) for name, figures in types.items())]
    if len(types) > 1:
        rows.append(_row("together", report))
    lines = [*_aligned(rows), EXPLAINED, "", *_findings(report), *_differences(report)]
    return "\n".join(map(clean, lines))


def quantity(size: float, unit: str = "B") -> str:
    """Return a size with a prefix: 12.3 MB."""
    for prefix in ("", "k", "M", "G"):
        if size < 999.5 or prefix == "G":
            return f"{size:.0f} {prefix}{unit}" if not prefix else f"{size:.3g} {prefix}{unit}"
        size /= 1000.0
    raise AssertionError


def span(seconds: float | None) -> str:
    """Return a short time: 12 ms, 3.4 s."""
    if seconds is None:
        return "-"
    return f"{1000 * seconds:.0f} ms" if seconds < 0.9995 else f"{seconds:.1f} s"


def part(some: float, of: float | None, digits: int = 1) -> str:
    """Return a part in percent; nothing where there is no whole."""
    return f"{100 * some / of:.{digits}f}%" if of else "-"


def _row(name: str, figures: Report) -> tuple[str, ...]:
    age = figures["age"] or {}
    return (
        name,
        f"{figures['messages']:,}",
        f"{figures['forwarded']:,} ({part(figures['forwarded'], figures['messages'], 0)})",
        quantity(figures["bytes"]),
        span(age.get("median")),
        span(age.get("p95")),
        f"{figures['utility']:.1f}",
        part(figures["utility"], figures["utility_all"]),
        part(figures["utility"], figures["bound"]),
    )


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(
            cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    return [lines[0], "  ".join("-" * width for width in widths), *lines[1:]]


def _findings(report: Report) -> list[str]:
    limits = ", ".join(f"{each['name']}: {limit_text(each)}" for each in report["limits"]) or "none"
    lines = [f"limits: {limits}; exceeded in {report['violations']:,} windows"]
    if report["lost"]:
        lines.append(f"{report['lost']:,} of the {report['forwarded']:,} samples sent were lost on the way")
    if report["decisions"]:
        each = 1000 * report["seconds_per_decision"]
        lines.append(f"{report['decisions']:,} searches of {each:.2f} ms on average; the other samples needed none")
    return lines


def limit_text(limit: Report) -> str:
    """Word a limit of the report."""
    if limit["unit"] == "B":
        return f"{quantity(8 * limit['limit'] / limit['window'], 'bit/s')} in windows of {limit['window']:g} s"
    return f"{limit['limit']:g} {limit['unit']} in windows of {limit['window']:g} s"


def _differences(report: Report) -> list[str]:
    found = report["differences"]
    if not found:
        return ["every sample fared as it was recorded"]
    lines = ["", "what fared otherwise than it was recorded:"]
    rows = [
        (f"  {each['messages']:,}", each["type"], f"{each['recorded']} -> {each['replayed']}")
        for each in found[:MOST_DIFFERENCES]
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(2)]
    lines += [f"{count.rjust(widths[0])}  {name.ljust(widths[1])}  {what}" for count, name, what in rows]
    more = len(found) - MOST_DIFFERENCES
    return [*lines, *([f"  and {more} more kinds; --json has all"] if more > 0 else [])]
