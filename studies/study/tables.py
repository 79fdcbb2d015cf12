"""The tables of the study's page."""

from collections.abc import Iterator
from statistics import fmean

from studies.benchmarks.report import Table
from studies.study.contenders import TITLES
from studies.study.measures import agreement, by_level, real_flights, shares_by_limit, spent_by
from studies.study.programme import COMPARED, REAL_TEAMS, SCENARIOS, Extent
from studies.study.results import Results

NONE = "–"
NETWORK_NAMES = {"infrastructure": "access point", "adhoc": "ad hoc"}


def contender_tables(results: Results, extent: Extent) -> Iterator[Table]:
    """Yield a table for each scenario: what contenders reach at each limit."""
    for scenario, title in SCENARIOS.items():
        columns = {name: shares_by_limit(results, extent, name, scenario) for name in extent.flying}
        columns = {name: points for name, points in columns.items() if points}
        limits = sorted({limit for points in columns.values() for limit in points})
        rows = [
            (f"{limit:g}", *(points[limit].percent() if limit in points else NONE for points in columns.values()))
            for limit in limits
        ]
        yield Table(
            f"Share of the bound: {title}",
            ("limit", *(TITLES[name] for name in columns)),
            tuple(rows),
            "Utility as a share of the bound at the same latency [%], with the 95 % confidence interval of the mean"
            " over missions; limits in messages per 2.5 s, of 25 that are generated.",
        )


def cost_table(results: Results, extent: Extent) -> Table:
    """Return what decisions of the contenders take, and how they keep to the limit."""
    rows = []
    for name in extent.flying:
        tasks = [t for scenario in SCENARIOS for own in by_level(extent, name, scenario).values() for t in own]
        records = [record for task in tasks if (record := results.record(task)) is not None]
        decided = [record["decision"] for record in records if record["decision"]]
        if not records:
            continue
        times = [f"{1000 * fmean(each[k] for each in decided):.3g}" for k in (0, 1)] if decided else [NONE, NONE]
        over, worst = fmean(record["over"] for record in records), max(record["worst"] for record in records)
        random = not shares_by_limit(results, extent, name, "mixed")
        kept = [NONE, NONE] if random else [f"{100 * over:.2f}", f"{100 * worst:.0f}"]
        cpu, told = fmean(record["cpu"] for record in records), fmean(record["told"] for record in records)
        rows.append((TITLES[name], *times, f"{cpu:.1f}", f"{told / 10:.0f}", *kept))
    return Table(
        "What decisions take",
        ("contender", "decision [ms]", "95th percentile [ms]", "flight [s]", "told [B/s]", "over [%]", "worst [%]"),
        tuple(rows),
        "Means over all flights: median and 95th percentile of the time of a decision, processor time of a whole flight"
        " (the network's included), what a robot tells others, windows that hold more messages than the limit, and the"
        " fullest window as a part of the limit. Other flights ran at the same time.",
    )


def real_table(results: Results, extent: Extent) -> Table:
    """Return what real traffic reaches over each network, what became of it, and what it takes."""
    rows = []
    for (workload, robots), flights in real_flights(results, extent).items():
        for (contender, network), tasks in flights.items():
            share = results.mean(tasks, results.share)
            records = [record for task in tasks if (record := results.record(task)) is not None]
            used = spent_by(results, tasks)
            if share is None or used is None:
                continue
            ages = [record["age"] for record in records]
            has_small = any(any(each) for each in ages)
            small = f"{100 * fmean(record['small'] for record in records):.1f}" if has_small else NONE
            age = " / ".join(f"{1000 * fmean(each[k] for each in ages):.1f}" for k in (0, 1)) if has_small else NONE
            times = " / ".join(f"{1000 * each:.2g}" for each in used.decision) if used.decision else NONE
            rows.append(
                (
                    f"{workload}, {robots} robots: {TITLES[contender]}",
                    NETWORK_NAMES[network],
                    share.percent(),
                    f"{100 * fmean(record['over'] for record in records):.1f}",
                    f"{max(record['worst'] for record in records):.2f}",
                    small,
                    age,
                    times,
                    f"{100 * used.cpu:.1f}" if contender in REAL_TEAMS else NONE,
                )
            )
    return Table(
        "What real traffic reaches",
        (
            "workload and contender",
            "network",
            "of the bound [%]",
            "over [%]",
            "fullest",
            "small [%]",
            "their age [ms]",
            "decision [ms]",
            "processor [%]",
        ),
        tuple(rows),
        "Utility of the operator as a share of the bound at the latency of the network; windows over the limit and the"
        " fullest, in limits; small samples that came, and their age then (median / 95th percentile); decision times"
        " (median / 95th percentile), and the part of a processor that one robot took, the network's included. Who does"
        " not plan, or decides for all, knows of everything at once, over a medium of our own that is as quick.",
    )


def agreement_table(results: Results, extent: Extent) -> Table:
    """Return what best mode reaches over each network."""
    rows = [
        (
            f"{SCENARIOS[scenario]}, {level:g} in 2.5 s",
            *(f"{100 * cells[name][0]:.1f} ({100 * cells[name][1]:.1f})" for name in COMPARED),
            f"{100 * (cells['own'][0] - cells['adhoc'][0]):+.1f}",
            f"{100 * (cells['own, unicast'][0] - cells['infrastructure'][0]):+.1f}",
        )
        for (scenario, level), cells in agreement(results, extent).items()
    ]
    names = ("ns-3 ad hoc, broadcast", "own, broadcast", "ns-3 infrastructure, unicast", "own, unicast")
    return Table(
        "Best mode over each network",
        ("mission", *names, "difference, broadcast", "difference, unicast"),
        tuple(rows),
        "Share of the bound [%], in brackets the part of copies that arrived [%]; differences in points.",
    )
