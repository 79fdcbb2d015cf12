"""Charts of results, drawn beside the page that shows them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

GREY, PALETTE = "#666666", ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
"""The palette of Okabe and Ito, which the colour-blind tell apart."""


@dataclass(frozen=True, slots=True)
class Series:
    """One value for each place on the x axis; None where nothing was measured."""

    name: str
    values: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class Chart:
    """Series side by side: as bars in groups, or as lines over numbers.

    `target` is a value that is to be reached, drawn as a line; `least` where the y axis begins.
    """

    title: str
    places: tuple[str, ...]
    series: tuple[Series, ...]
    unit: str
    kind: Literal["bars", "lines"] = "bars"
    target: float | None = None
    least: float = 0.0
    logarithmic: bool = False

    def file_name(self) -> str:
        """Return the name of its picture: the title in small letters."""
        words = "".join(letter if letter.isalnum() else " " for letter in self.title.lower()).split()
        return "-".join(words) + ".png"

    def draw(self, path: Path, origin: str) -> None:
        """Draw it to a PNG file; `origin` says below when and where it was measured."""
        import matplotlib as mpl  # noqa: PLC0415 - belongs to the extra "study"

        mpl.use("Agg")
        from matplotlib import pyplot as plt  # noqa: PLC0415

        rows = (len(self.series) + 2) // 2
        size = (max(7.5, 1.3 * len(self.places)), 4.0 + 0.17 * rows)
        figure, axes = plt.subplots(figsize=size, dpi=110, layout="constrained")
        if self.kind == "bars":
            self._bars(axes)
        else:
            self._lines(axes)
        self._frame(axes)
        figure.suptitle(self.title, fontsize=10)
        axes.set_title(origin, fontsize=6.5, color=GREY)
        figure.legend(fontsize=7, frameon=False, loc="outside lower center", ncols=2)
        figure.savefig(path, metadata={"Software": None})
        plt.close(figure)

    def _bars(self, axes: Any) -> None:
        width = 0.8 / len(self.series)
        for number, series in enumerate(self.series):
            known = [(at, value) for at, value in enumerate(series.values) if value is not None]
            places = [at - 0.4 + width * (number + 0.5) for at, _ in known]
            heights = [value - self.least for _, value in known]
            axes.bar(places, heights, width, self.least, label=series.name, color=PALETTE[number % len(PALETTE)])
        axes.set_xticks(range(len(self.places)), self.places, fontsize=8)

    def _lines(self, axes: Any) -> None:
        for number, series in enumerate(self.series):
            known = [(at, value) for at, value in enumerate(series.values) if value is not None]
            colour = PALETTE[number % len(PALETTE)]
            axes.plot([at for at, _ in known], [y for _, y in known], marker="o", label=series.name, color=colour)
        axes.set_xticks(range(len(self.places)), self.places, fontsize=8)

    def _frame(self, axes: Any) -> None:
        axes.set_ylabel(self.unit)
        if self.logarithmic:
            axes.set_yscale("log")
        else:
            axes.set_ylim(bottom=self.least)
        if self.target is not None:
            axes.axhline(self.target, color=GREY, linewidth=1, linestyle="--", label=f"to reach: {self.target:g}")
        axes.grid(axis="y", color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
