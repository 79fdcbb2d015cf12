"""The figures of the study, drawn of its results."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studies.study.characteristic import BINS, LEVELS, Characteristic
from studies.study.contenders import BOUND, TITLES
from studies.study.drawing import OTHERS, STYLES, figure, framed, line
from studies.study.errors import StudyError
from studies.study.measures import Curve, curve, gains_of, shares_by_limit, swept
from studies.study.programme import SCENARIOS, Extent, Sweep
from studies.study.results import Results

LETTERS = dict(zip(SCENARIOS, "abc", strict=True))
ECDF = 401
"""Points of an eCDF."""
LEAST = 5.0
"""An axis of shares leaves so much room below what it shows [points]."""


def figure_3(results: Results, extent: Extent, folder: Path) -> str:
    """Draw Fig. 3 of the paper anew: utility by messages, and the characteristic below it. Return its name."""
    name = "study-figure-3"
    shown = [each for each in ("random", "paper-alone", "paper", "best") if each in extent.flying]
    with figure(folder, name, 2, 3, (11, 7), sharex="row", sharey="row") as (drawn, axes):
        for column, (scenario, title) in enumerate(SCENARIOS.items()):
            for contender in [*shown, BOUND]:
                _messages(axes[0][column], curve(results, extent, contender, scenario), contender)
            _titled(axes[0][column], f"({LETTERS[scenario]}) {title}", "messages sent [% of all]")
            _characteristic(axes[1][column], gains_of(results, extent, scenario))
        axes[0][0].set(ylabel="utility [% of maximum]", xlim=(0, 101), ylim=(0, 101))
        axes[1][0].set(ylabel="messages [%]")
        handles, labels = axes[0][0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside upper center", ncols=5, frameon=False)
        handles, labels = axes[1][0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
    return name


def _messages(axes: Any, points: Curve, contender: str) -> None:
    means = [(100 * sent, mean) for sent, mean in points.means]
    line(axes, STYLES[contender], means, TITLES[contender])


def _characteristic(axes: Any, gained: Sequence[float]) -> None:
    try:
        found = Characteristic.of(gained)
    except StudyError:
        axes.text(0.5, 0.5, "no message was sent at random", ha="center", transform=axes.transAxes)
        return
    draw_characteristic(axes, found)


def draw_characteristic(axes: Any, found: Characteristic) -> None:
    """Draw the histogram and the eCDF of a characteristic."""
    width = 1.0 / BINS
    places = (np.arange(BINS) + 0.5) * width
    bars = 100 * found.histogram()
    axes.bar(places, bars, 0.9 * width, color="#56B4E9", edgecolor="#0072B2", linewidth=0.6, label="histogram")
    steps = np.linspace(0.0, 1.0, ECDF)
    axes.plot(steps, [100 * found.below(each) for each in steps], color="#006d4f", linewidth=1.8, label="eCDF")
    axes.set(xlabel="expected utility [part of the greatest]", xlim=(0, 1), ylim=(0, 101))
    for number, (level, part) in enumerate(found.levels.items()):
        axes.axvline(number / len(LEVELS), color="#999999", linewidth=0.7, linestyle=":")
        place = (number + 0.5) / len(LEVELS)
        axes.text(place, 103, f"{level}: {100 * part:.0f} %", ha="center", va="bottom", fontsize=8)
    framed(axes)


def shares(results: Results, extent: Extent, folder: Path) -> str:
    """Draw the share of the bound of all contenders by limit. Return its name."""
    name = "study-contenders"
    contenders = [each for each in extent.flying if shares_by_limit(results, extent, each, "mixed")]
    with figure(folder, name, 1, 3, (12, 4.8), sharey="row") as (drawn, axes):
        for column, (scenario, title) in enumerate(SCENARIOS.items()):
            for contender in contenders:
                points = shares_by_limit(results, extent, contender, scenario)
                line(axes[0][column], STYLES[contender], list(points.items()), TITLES[contender])
            axes[0][column].axhline(95, color="#999999", linewidth=0.8, linestyle=(0, (1, 3)))
            _titled(axes[0][column], f"({LETTERS[scenario]}) {title}", "limit [messages in 2.5 s]")
        axes[0][0].set(ylabel="utility [% of the bound at the same latency]", ylim=(None, 102))
        handles, labels = axes[0][0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
    return name


def sweep_figure(results: Results, extent: Extent, sweep: Sweep, folder: Path) -> str:
    """Draw a sweep. Return its name."""
    name = f"study-{sweep.name}"
    with figure(folder, name, 1, 1, (6.2, 4.0)) as (_, ((axes,),)):
        lowest = 100.0
        for style, (title, points) in zip(OTHERS, swept(results, extent, sweep).items(), strict=False):
            lowest = min([lowest, *(100 * mean.mean for mean in points.values())])
            line(axes, style, list(points.items()), title)
        if sweep.logarithmic:
            ticks = [x for x, _ in sweep.points]
            if min(ticks) > 0:
                axes.set_xscale("log")
            else:
                axes.set_xscale("symlog", linthresh=min(x for x in ticks if x > 0))
            axes.set_xticks(ticks, [f"{x:g}" for x in ticks])
            axes.minorticks_off()
        of = "the bound at the same latency" if sweep.of == "bound" else "the maximum"
        axes.set(ylabel=f"utility [% of {of}]", ylim=(max(0.0, lowest - LEAST), 101.5))
        _titled(axes, sweep.title, sweep.axis)
        axes.legend(frameon=False, fontsize=8)
    return name


def _titled(axes: Any, title: str, x: str) -> None:
    axes.set_title(title, fontsize=10)
    axes.set_xlabel(x)
    framed(axes)
