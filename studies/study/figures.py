"""The figures of the study, drawn of its results."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from studies.study.characteristic import BINS, LEVELS, Characteristic
from studies.study.contenders import BOUND, TITLES
from studies.study.drawing import OTHERS, STYLES, Style, figure, framed, line
from studies.study.errors import StudyError
from studies.study.measures import Curve, Spent, curve, gains_of, real_flights, shares_by_limit, spent, swept
from studies.study.programme import CARRIED, REAL_OTHERS, REAL_TEAMS, SCENARIOS, Extent, Sweep
from studies.study.results import Results

LETTERS = dict(zip(SCENARIOS, "abc", strict=True))
ECDF = 401
"""Points of an eCDF."""
SIDEWAYS = 0.12
"""Marks of one workload stand so far apart."""
ABOVE = 1.15
"""So high, in parts of what they show, are axes that begin at nothing."""
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
    with figure(folder, name, 3, 1, (6.2, 6.2), sharex=True, height_ratios=(4, 1, 1)) as (
        _,
        ((axes,), (times,), (use,)),
    ):
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
        _titled(axes, sweep.title, "")
        axes.legend(frameon=False, fontsize=8)
        for style, what in zip(OTHERS, spent(results, extent, sweep).values(), strict=False):
            _spent(times, use, style, what)
        times.set(ylabel="decision\n[ms]")
        use.set(ylabel="processor\n[%]", xlabel=sweep.axis)
        for below in (times, use):
            below.set_ylim(0.0, ABOVE * max(below.dataLim.y1, 1e-3))
            framed(below)
    return name


def _spent(times: Any, use: Any, style: Style, points: dict[float, Spent]) -> None:
    """Draw the median of decision times, as a bar up to the 95th percentile, and the processor time of a robot."""
    timed = {x: what.decision for x, what in points.items() if what.decision is not None}
    how: dict[str, Any] = {
        "color": style.colour,
        "marker": style.mark,
        "linestyle": style.dashes,
        "markersize": 4,
        "markerfacecolor": "none",
        "linewidth": 1.1,
    }
    if timed:
        middles = [1000 * middle for middle, _ in timed.values()]
        above = [1000 * max(late - middle, 0.0) for middle, late in timed.values()]
        times.errorbar(list(timed), middles, yerr=([0.0] * len(above), above), elinewidth=0.7, capsize=2, **how)
    use.plot(list(points), [100 * what.cpu for what in points.values()], **how)


def real_figure(results: Results, extent: Extent, folder: Path) -> str:
    """Draw what real traffic reaches over each network. Return its name."""
    name = "study-real"
    flights = real_flights(results, extent)
    with figure(folder, name, 1, len(CARRIED), (9, 4.2), sharey="row") as (drawn, axes):
        for column, (carried, what) in enumerate(CARRIED.items()):
            for place, contender in enumerate((*REAL_TEAMS, *REAL_OTHERS)):
                points = [
                    (number + SIDEWAYS * (place - (len(REAL_TEAMS) + len(REAL_OTHERS) - 1) / 2), mean)
                    for number, own in enumerate(flights.values())
                    if (mean := results.mean(own.get((contender, carried), ()), results.share)) is not None
                ]
                line(axes[0][column], replace(STYLES[contender], dashes=""), points, TITLES[contender])
            names = [f"{workload}\n{robots} robots" for workload, robots in flights]
            axes[0][column].set_xticks(range(len(names)), names, fontsize=8)
            _titled(axes[0][column], f"over ns-3, {what}", "")
        axes[0][0].set(ylabel="utility [% of the bound at the same latency]", ylim=(None, 101.5))
        handles, labels = axes[0][0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
    return name


def _titled(axes: Any, title: str, x: str) -> None:
    axes.set_title(title, fontsize=10)
    axes.set_xlabel(x)
    framed(axes)
