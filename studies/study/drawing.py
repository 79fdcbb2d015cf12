"""How figures of the study look: lines that are told apart by colour, in grey and by their marks; SVG and PNG."""

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.study.results import Mean

GREY, LIGHT = "#666666", "#dddddd"


@dataclass(frozen=True, slots=True)
class Style:
    """Colours are those of Okabe and Ito; no two lines share both their mark and their dashes."""

    colour: str
    mark: str
    dashes: str = "-"


STYLES = {
    "bound": Style("#000000", "", "--"),
    "central": Style("#999999", "D", ":"),
    "best": Style("#D55E00", "x", "-"),
    "paper": Style("#0072B2", "o", "-"),
    "paper-alone": Style("#0072B2", "s", "--"),
    "best-alone": Style("#D55E00", "^", "--"),
    "random": Style("#56B4E9", "+", ":"),
    "greedy": Style("#009E73", "v", "-"),
    "rank": Style("#CC79A7", "<", "--"),
    "fixed-rate": Style("#E69F00", "P", "-."),
    "age": Style("#009E73", "*", ":"),
    "receding": Style("#000000", "h", ":"),
    "reserve": Style("#009E73", "v", "-."),
    "static": Style("#CC79A7", "<", "-."),
}
"""By contender."""
OTHERS = (
    Style("#D55E00", "x", "-"),
    Style("#0072B2", "o", "--"),
    Style("#000000", "s", ":"),
    Style("#009E73", "v", "-."),
)
"""For lines that are not contenders of their own."""
SETTINGS: dict[str, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "sendworthy",
    "font.size": 9,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
}


METADATA: dict[str, dict[str, Any]] = {
    ".svg": {"Date": None, "Creator": None},
    ".png": {"Software": None},
    ".pdf": {"CreationDate": None},
}
"""What is left out, so that the same figures make the same files."""


@contextmanager
def figure(folder: Path, name: str, rows: int, columns: int, size: tuple[float, float], **layout: Any) -> Iterator[Any]:
    """Yield a figure and its axes, `[row][column]`, and write it as `name`.svg and `name`.png."""
    folder.mkdir(parents=True, exist_ok=True)
    with _drawn([folder / f"{name}.svg", folder / f"{name}.png"], rows, columns, size, **layout) as drawn:
        yield drawn


@contextmanager
def one_axes(path: Path) -> Iterator[Any]:
    """Yield the axes of a figure that is written to a file."""
    with _drawn([path], 1, 1, (6.4, 4.2)) as (_, axes):
        yield axes[0][0]


@contextmanager
def _drawn(paths: Sequence[Path], rows: int, columns: int, size: tuple[float, float], **layout: Any) -> Iterator[Any]:
    import matplotlib as mpl  # noqa: PLC0415 - belongs to the extra "study"

    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415

    settings: Any = SETTINGS
    with mpl.rc_context(settings):
        drawn, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained", **layout)
        try:
            yield drawn, axes
            for path in paths:
                kind, written = path.suffix.removeprefix("."), io.BytesIO()
                drawn.savefig(written, format=kind, dpi=130, metadata=METADATA[path.suffix])
                path.write_bytes(written.getvalue())  # by ourselves: on a full disk the writer of .pdf fails otherwise
        finally:
            plt.close(drawn)


def framed(axes: Any) -> None:
    """Give axes a light grid."""
    axes.grid(visible=True, color=LIGHT, linewidth=0.6)


def line(axes: Any, style: Style, points: Sequence[tuple[float, Mean]], label: str) -> None:
    """Draw means with their confidence intervals, where there are any [%]."""
    xs, ys = [x for x, _ in points], [100 * mean.mean for _, mean in points]
    halves = [None if mean.half is None else 100 * mean.half for _, mean in points]
    bars = [0.0 if half is None else half for half in halves]
    axes.errorbar(
        xs,
        ys,
        yerr=bars if any(bars) else None,
        color=style.colour,
        marker=style.mark or None,
        linestyle=style.dashes,
        markersize=5,
        markerfacecolor="none",
        linewidth=1.4,
        elinewidth=0.8,
        capsize=2,
        label=label,
    )
