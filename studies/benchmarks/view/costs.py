"""Tables of what latency, loss, wrong clocks and churn cost each arrangement, and where it goes."""

from collections.abc import Iterator, Sequence
from statistics import fmean

from studies.benchmarks.report import Table
from studies.benchmarks.view.flown import Flown
from studies.benchmarks.view.programme import CLOCK_ERROR, FAR, Extent, wrong_clocks
from studies.benchmarks.view.targets import Results, by_arrangement
from studies.workload import SCENARIOS


def cost_table(results: Results, extent: Extent) -> Table:
    """Return a row for each condition: shares of the bound and of one central decider."""
    usual = results["usual"]
    conditions: list[tuple[str, Sequence[Flown]]] = [
        ("latency 20 ms, loss 1 %", usual),
        *((f"latency {1000 * t:g} ms", _with(results, "latency", t)) for t in extent.latencies),
        (f"latency {1000 * FAR:g} ms, wall clocks known to {1000 * CLOCK_ERROR:g} ms", results["known clocks"]),
        *((f"loss {100 * p:g} %", _with(results, "loss", p)) for p in extent.losses),
        *((f"{what}, loss 0", results[what]) for what in wrong_clocks(extent)),
        ("a crash, a leave, two joins", results["churn"]),
    ]
    columns = [name for _, name, _ in by_arrangement(usual)]
    rows = tuple((name, *(_cell(of) for _, _, of in by_arrangement(flown))) for name, flown in conditions)
    return Table(
        f"What bad networks cost, r = {extent.usual}",
        ("condition", *columns),
        rows,
        "Share of one central decider at the same latency and loss [%], in brackets the share of the offline bound,"
        " which loses nothing. After the / the part of windows that exceed the limit [%], and the most messages too"
        f" many. {extent.many} seeds of each latency, {extent.seeds} of losses and churn, one of clocks. While a robot"
        " is gone its samples are not published; the bound and the central decider have them.",
    )


def detail_table(results: Results) -> Table:
    """Return a row for each limit and scenario of every arrangement: what was reached, and why not more."""
    rows = tuple(
        (f"{name}, r = {limit}, {SCENARIOS[scenario].name}", *_details(flown))
        for _, name, of in by_arrangement(results["limits"])
        for limit, scenario, flown in _points(of)
    )
    return Table(
        "Every limit and scenario",
        (
            "flights",
            "of central",
            "of bound",
            "central of bound",
            "sent",
            "central sent",
            "exceeding",
            "told",
            "digest every",
            "forecasts off",
        ),
        rows,
        "Shares [%]; messages per second; windows that exceed the limit [%], and the most messages too many; what a"
        " robot tells the others [B/s], and the time between its digests [s]; median error of others' predicted"
        " generation times [% of the period].",
    )


def _with(results: Results, name: str, value: float) -> list[Flown]:
    return [one for one in results[name] if getattr(one.flight.how, name) == value]


def _cell(flown: Sequence[Flown]) -> str:
    share, bound = fmean(one.of_central for one in flown), fmean(one.of_bound for one in flown)
    return f"{100 * share:.1f} ({100 * bound:.1f}) / {_excess(flown)}"


def _excess(flown: Sequence[Flown]) -> str:
    return f"{100 * fmean(one.used.exceeding for one in flown):.1f}, {max(one.used.worst for one in flown)}"


def _points(flown: Sequence[Flown]) -> Iterator[tuple[int, int, list[Flown]]]:
    points = sorted({(one.flight.how.limit, one.flight.course.scenario) for one in flown})
    for limit, scenario in points:
        own = [o for o in flown if (o.flight.how.limit, o.flight.course.scenario) == (limit, scenario)]
        yield limit, scenario, own


def _details(flown: Sequence[Flown]) -> tuple[str, ...]:
    return (
        f"{100 * fmean(one.of_central for one in flown):.1f}",
        f"{100 * fmean(one.of_bound for one in flown):.1f}",
        f"{100 * fmean(one.central_of_bound for one in flown):.1f}",
        f"{fmean(one.used.messages for one in flown):.2f}",
        f"{fmean(one.central_messages for one in flown):.2f}",
        _excess(flown),
        f"{fmean(one.used.told for one in flown):.0f}",
        f"{fmean(one.used.interval for one in flown):.1f}",
        f"{100 * fmean(one.others[0] for one in flown):.1f}",
    )
