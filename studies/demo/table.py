"""The demo's result as a table: without and with the filter, robots while they see red and the others."""

from collections.abc import Callable, Iterator, Mapping

from studies.demo.figures import Figures
from studies.demo.nodes import WITH, WITHOUT

Value = float | None
_WIDTHS = (44, 10, 10, 14, 10)


def table(figures: Mapping[str, Figures]) -> str:
    """Return the table as text."""
    return "\n".join(_lines(figures[WITHOUT], figures[WITH]))


def _lines(without: Figures, with_: Figures) -> Iterator[str]:
    both = (without, with_)
    yield _row("", "without", "", "with Sendworthy", "")
    yield _row("", "red", "other", "red", "other")
    for title, name in _OF_CLASSES:
        yield _row(title, *(_number(f[f"{name}_{kind}"]) for f in both for kind in ("red", "other")))
    for title, name, write in _OF_BOTH:
        first, second = (write(f[name]) for f in both)
        yield _row(title, first, "", second, "")


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
_OF_BOTH: tuple[tuple[str, str, Callable[[Value], str]], ...] = (
    ("frame rate, red to other", "fps_ratio", _number),
    ("  the same in the offline optimum", "fps_ratio_optimum", _number),
    ("end of red on the screen, 95 % [s]", "end_p95", _number),
    ("red on screens where there is none [s]", "false_red", _number),
    ("utility, of all sent without delay", "utility_share", _percent),
    ("utility, of the offline optimum", "utility_share_optimum", _percent),
    ("carried by the medium", "medium_bytes", _megabytes),
    ("offered at most, of the spec's limit", "offered_max_share", _percent),
    ("every sample accounted for", "conserved", _truth),
    ("connections around the medium", "direct_links", _count),
)
