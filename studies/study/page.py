"""Writes the page of the study: figures, tables, and in words what they mean; and all figures as JSON."""

import json
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

from studies.benchmarks.report import Table, machine
from studies.study import figures, words
from studies.study.characteristic import Characteristic
from studies.study.contenders import BOUND
from studies.study.measures import curve, gains_of, real_flights, shares_by_limit, spent, swept
from studies.study.programme import SCENARIOS, Extent, everything, sweeps
from studies.study.results import Mean, Results
from studies.study.tables import agreement_table, contender_tables, cost_table, real_table

FIGURES = "results"
"""The folder of figures beside the page."""


def write(results: Results, extent: Extent, path: Path, now: datetime) -> None:
    """Write the page, its figures and `study.json`; folders are made as needed."""
    folder = path.parent / FIGURES
    folder.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join(_sections(results, extent, folder, now)) + "\n", encoding="utf-8")
    (folder / "study.json").write_text(json.dumps(_data(results, extent, now), indent=1) + "\n", encoding="utf-8")


def _sections(results: Results, extent: Extent, folder: Path, now: datetime) -> Iterator[str]:
    yield "# The simulation study"
    yield f"Written by `make study` ({extent.name}) on {now:%Y-%m-%d %H:%M} UTC. {machine()}."
    yield words.flown(results, extent)
    yield "## Figure 3 of the paper"
    yield _picture(figures.figure_3(results, extent, folder), "Utility by messages, and the characteristic below")
    yield from words.figure_3(results, extent)
    yield "## All contenders, as a share of the bound"
    yield _picture(figures.shares(results, extent, folder), "Share of the bound by limit")
    yield from words.contenders(results, extent)
    yield from (_section(table) for table in contender_tables(results, extent))
    yield _section(cost_table(results, extent))
    yield "## Our own medium beside ns-3"
    yield from words.networks(results, extent)
    yield _section(agreement_table(results, extent))
    yield "## Beyond"
    yield (
        f"Of the scenario mixed, {extent.sweep_seeds} missions of {extent.sweep_seconds:g} s for each point, five"
        " messages in 2.5 s where nothing else is said; bars are 95 % confidence intervals, wide of few missions. Below"
        " the utility stand the time of a decision, the median with a bar up to the 95th percentile, and the part of a"
        " processor that one robot took in the flight's time, the network's simulation included."
    )
    for sweep in sweeps(extent):
        if any(swept(results, extent, sweep).values()):
            yield _picture(figures.sweep_figure(results, extent, sweep, folder), sweep.title)
            yield words.sweep(results, extent, sweep)
    yield "## Real traffic"
    yield from words.real_traffic(results, extent)
    yield _picture(figures.real_figure(results, extent, folder), "Real traffic over each network")
    yield _section(real_table(results, extent))
    yield "## Beside the paper"
    yield from words.beside_the_paper(results, extent)


def _picture(name: str, title: str) -> str:
    return f"![{title}]({FIGURES}/{name}.png)\n\n([{name}.svg]({FIGURES}/{name}.svg))"


def _section(table: Table) -> str:
    """A table one level below the sections of the page."""
    return f"#{table.markdown()}"


def _data(results: Results, extent: Extent, now: datetime) -> dict[str, Any]:
    """Return all figures as plain data: means with half of their 95 % confidence intervals."""
    known = results.store.of(everything(extent))
    return {
        "extent": extent.name,
        "written": f"{now:%Y-%m-%d %H:%M} UTC",
        "machine": machine(),
        "flights": len(known),
        "scenarios": {scenario: _scenario(results, extent, scenario) for scenario in SCENARIOS},
        "sweeps": {
            sweep.name: {
                title: [{"x": x} | _plain(mean) for x, mean in points.items()]
                for title, points in swept(results, extent, sweep).items()
            }
            for sweep in sweeps(extent)
        },
        "spent": {
            sweep.name: {
                title: [
                    {"x": x, "decision": what.decision, "processor": round(what.cpu, 6)} for x, what in points.items()
                ]
                for title, points in spent(results, extent, sweep).items()
            }
            for sweep in sweeps(extent)
        },
        "real": {
            f"{workload}:{robots}": [
                {"contender": contender, "network": network} | _plain(mean)
                for (contender, network), tasks in flights.items()
                if (mean := results.mean(tasks, results.share)) is not None
            ]
            for (workload, robots), flights in real_flights(results, extent).items()
        },
    }


def _scenario(results: Results, extent: Extent, scenario: str) -> dict[str, Any]:
    found: dict[str, Any] = {"of_maximum": {}, "of_bound": {}}
    for contender in [*extent.flying, BOUND]:
        means = curve(results, extent, contender, scenario).means
        found["of_maximum"][contender] = [{"sent": sent} | _plain(mean) for sent, mean in means]
        limits = shares_by_limit(results, extent, contender, scenario)
        found["of_bound"][contender] = [{"limit": limit} | _plain(mean) for limit, mean in limits.items()]
    gained = gains_of(results, extent, scenario)
    if any(gained):
        found["characteristic"] = [round(part, 5) for part in Characteristic.of(gained).histogram().tolist()]
    return found


def _plain(mean: Mean) -> dict[str, Any]:
    half = None if mean.half is None else round(mean.half, 6)
    return {"mean": round(mean.mean, 6), "half": half, "missions": mean.count}
