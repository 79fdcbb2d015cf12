"""The demo's result as a table: run by run, robots while they see red and the others."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from studies.demo.figures import Figures
from studies.demo.nodes import PHASES

Value = float | None
_WIDTHS = (38, *(7, 7) * len(PHASES))
"""Of the title, and of two columns for each run [characters]: 80 in all."""


def table(figures: Mapping[str, Figures]) -> str:
    """Return the table as text."""
    return "\n".join(_lines([figures[phase] for phase in PHASES]))


def _lines(runs: Sequence[Figures]) -> Iterator[str]:
    yield _heads()
    yield _row("", *("red", "other") * len(runs))
    for title, name in _OF_CLASSES:
        yield _row(title, *(_number(run[f"{name}_{kind}"]) for run in runs for kind in ("red", "other")))
    for title, name, write in _OF_ALL:
        yield _row(title, *(cell for run in runs for cell in ("", write(run[name]))))


def _heads() -> str:
    """Name the runs, each at the end of its two columns."""
    return " " * _WIDTHS[0] + "".join(phase.rjust(sum(_WIDTHS[1:3])) for phase in PHASES)


def _row(*cells: str) -> str:
    title, *others = (cell.rjust(width) for cell, width in zip(cells, _WIDTHS, strict=True))
    return (title.strip().ljust(_WIDTHS[0]) + "".join(others)).rstrip()


def _number(value: Value) -> str:
    return "–" if value is None else f"{value:.2f}"


def _percent(value: Value) -> str:
    return "–" if value is None else f"{100 * value:.0f} %"


def _megabytes(value: Value) -> str:
    return "–" if value is None else f"{value / 1e6:.2f} MB"


def _truth(value: Value) -> str:
    return "–" if value is None else ("yes" if value else "NO")


def _count(value: Value) -> str:
    return "–" if value is None else str(value)


_OF_CLASSES = (
    ("frames per second and robot", "fps"),
    ("age of a frame, median [s]", "age_p50"),
    ("age of a frame, 95 % [s]", "age_p95"),
    ("staleness of the screen, median [s]", "staleness_p50"),
    ("staleness of the screen, 95 % [s]", "staleness_p95"),
)
_OF_ALL: tuple[tuple[str, str, Callable[[Value], str]], ...] = (
    ("frame rate, red to other", "fps_ratio", _number),
    ("  the same in the offline optimum", "fps_ratio_optimum", _number),
    ("start of red on the screen, 95 % [s]", "start_p95", _number),
    ("end of red on the screen, 95 % [s]", "end_p95", _number),
    ("red on screens where there is none [s]", "false_red", _number),
    ("oldest screen [s]", "staleness_max", _number),
    ("utility, of all sent without delay", "utility_share", _percent),
    ("utility, of the offline optimum", "utility_share_optimum", _percent),
    ("carried by the medium", "medium_bytes", _megabytes),
    ("offered at most, of the spec's limit", "offered_max_share", _percent),
    ("every sample accounted for", "conserved", _truth),
    ("connections around the medium", "direct_links", _count),
)
