"""The table of targets: what is asked of the shared view, and what was measured."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean

from studies.benchmarks.report import Table
from studies.benchmarks.view.flown import Flown
from studies.benchmarks.view.programme import ARRANGEMENTS, CLOCK_ERROR, FAR, LATENCY, Extent, arrangement, wrong_clocks
from studies.simulation.conditions import WINDOW, Conditions
from studies.simulation.missions import SIZE

Results = Mapping[str, Sequence[Flown]]
Row = tuple[str, str, str, str]

OF_CENTRAL = {"announce": 0.95, "split": 0.85}
"""What is asked of each coordination, as a share of one central decider."""
SAME = 0.99
MAY_EXCEED = {"announce": (0.01, 1), "split": (0.0, 0)}
"""What part of windows may exceed the limit, and by how many messages."""
FORECAST = 0.1
LATENCY_COSTS = 0.03


def target_table(results: Results, extent: Extent, others: Sequence[Row]) -> Table:
    """Return a row for each target; `others` are rows measured elsewhere."""
    rows = [
        *_forecasts(results, extent),
        *_clocks(results, extent),
        *_central(results),
        *_exceeding(results),
        *_latency(results),
        *_told(results),
        *others,
    ]
    return Table(
        "Targets",
        ("what", "asked", "measured", "met"),
        tuple(rows),
        f"{extent.robots} robots at about 1 Hz, {SIZE:,} B, r of {2.5 * extent.robots:g} messages per {WINDOW:g} s,"
        f" {extent.seconds:g} s after 10 s of warm-up, {extent.seeds} seeds ({extent.many} to compare latencies),"
        f" latency {1000 * LATENCY:g} ms and loss 1 % unless something else is said. In unicast one operator wants"
        " everything, in broadcast every robot does. The limit is what messages have; what robots tell each other comes"
        " on top unless it is said to be inside.",
    )


def by_arrangement(flown: Sequence[Flown]) -> Iterator[tuple[str, str, list[Flown]]]:
    """Yield every coordination, the name of its arrangement, and its flights."""
    for coordination, transport in ARRANGEMENTS:
        name = arrangement(Conditions(coordination=coordination, transport=transport))
        yield coordination, name, [one for one in flown if arrangement(one.flight.how) == name]


def met(holds: bool) -> str:  # noqa: FBT001 -- it is the only argument
    """Return the word for it."""
    return "yes" if holds else "no"


def lawful(flown: Sequence[Flown]) -> bool:
    """Whether flights of one arrangement exceed the limit no more than they may."""
    most, by = MAY_EXCEED[flown[0].flight.how.coordination]
    return fmean(one.used.exceeding for one in flown) <= most and max(one.used.worst for one in flown) <= by


def _unless_lawful(flown: Sequence[Flown]) -> str:
    return "" if lawful(flown) else ", by exceeding the limit"


def _forecasts(results: Results, extent: Extent) -> Iterator[Row]:
    for loss in extent.losses:
        flown = [one for one in results["forecasts"] if one.flight.how.loss == loss]
        medians = {name: fmean(one.others[0] for one in of) for _, name, of in by_arrangement(flown)}
        tails = {name: fmean(one.others[1] for one in of) for _, name, of in by_arrangement(flown)}
        own = fmean(one.own[0] for one in flown)
        figures = "; ".join(f"{name} {100 * medians[name]:.1f} % ({100 * tails[name]:.0f} %)" for name in medians)
        yield (
            f"Error of others' predicted generation times, loss {100 * loss:g} %, jitter 10 %",
            f"median ≤ {100 * FORECAST:g} % of the period",
            f"{figures}; of own streams {100 * own:.1f} % (in brackets 95th percentiles)",
            met(max(medians.values()) <= FORECAST),
        )


def _clocks(results: Results, extent: Extent) -> Iterator[Row]:
    for what in wrong_clocks(extent):
        pairs = list(zip(results["right clocks"], results[what], strict=True))
        same = [
            (
                name,
                fmean(one.alike or 0.0 for one in flown),
                fmean(right.same_as(wrong) for right, wrong in pairs if arrangement(right.flight.how) == name),
            )
            for _, name, flown in by_arrangement(results[what])
        ]
        yield (
            f"Decisions equal to those with right clocks, each by itself (in whole flights, which part): {what}",
            f"≥ {100 * SAME:g} %",
            "; ".join(f"{name} {100 * alike:.2f} % ({100 * whole:.1f} %)" for name, alike, whole in same),
            met(min(alike for _, alike, _ in same) >= SAME),
        )


def _central(results: Results) -> Iterator[Row]:
    for coordination, name, flown in by_arrangement(results["limits"]):
        reached, asked = fmean(one.of_central for one in flown), OF_CENTRAL[coordination]
        worst = min(one.of_central for one in flown)
        yield (
            f"Utility beside one central decider: {name}",
            f"≥ {100 * asked:g} %",
            f"{100 * reached:.1f} %, worst mission {100 * worst:.1f} %{_unless_lawful(flown)}",
            met(reached >= asked and lawful(flown)),
        )


def _exceeding(results: Results) -> Iterator[Row]:
    for coordination, name, flown in by_arrangement(results["limits"]):
        share, worst = fmean(one.used.exceeding for one in flown), max(one.used.worst for one in flown)
        most, by = MAY_EXCEED[coordination]
        yield (
            f"Windows in which the union exceeds the limit: {name}",
            f"≤ {100 * most:g} %, by at most {by}" if by else "none",
            f"{100 * share:.2f} %, by at most {worst} messages",
            met(lawful(flown)),
        )


def _latency(results: Results) -> Iterator[Row]:
    far = [one for one in results["latency"] if one.flight.how.latency == FAR]
    known = f", wall clocks known to {1000 * CLOCK_ERROR:g} ms"
    yield from _later(results["usual"], far)
    yield from _later(results["usual"], results["known clocks"], known)


def _later(usual: Sequence[Flown], far: Sequence[Flown], besides: str = "") -> Iterator[Row]:
    for _, name, flown in by_arrangement(far):
        late = [one.of_bound for one in flown]
        near = [one.of_bound for one in usual if arrangement(one.flight.how) == name]
        lost = fmean(near) - fmean(late)
        yield (
            f"Latency {FAR:g} s beside 20 ms, each as a share of the bound at its latency: {name}{besides}",
            f"within {100 * LATENCY_COSTS:g} points",
            f"{100 * fmean(late):.1f} % beside {100 * fmean(near):.1f} %{_unless_lawful(flown)}",
            met(lost <= LATENCY_COSTS and lawful(flown)),
        )


def _told(results: Results) -> Iterator[Row]:
    for _, name, flown in by_arrangement(results["limits"]):
        over = max(one.used.told - allowed(one.flight.how) for one in flown)
        figures = ", ".join(
            f"{fmean(one.used.told for one in flown if one.flight.how.limit == limit):.0f} B/s (r = {limit})"
            for limit in sorted({one.flight.how.limit for one in flown})
        )
        inside = [one for one in results["inside"] if arrangement(one.flight.how) == name]
        limit = limit_of(inside)
        outside = [one for one in flown if one.flight.how.limit == limit]
        central = f"of central {_percent(outside)} with it on top of the limit, {_percent(inside)} with it inside"
        yield (
            f"What a robot tells the others: {name}",
            "≤ the larger of 2 % of the limit and 100 B/s",
            f"{figures}; r = {limit}: {central}",
            met(over <= 0.0),
        )


def allowed(how: Conditions) -> float:
    """What a robot may tell the others [B/s], all copies together."""
    return max(0.02 * how.gross(how.limit * SIZE) / WINDOW / how.members, 100.0)


def limit_of(flown: Sequence[Flown]) -> int:
    """Return the limit that all of these were flown with [messages]."""
    return flown[0].flight.how.limit


def _percent(flown: Sequence[Flown]) -> str:
    return f"{100 * fmean(one.of_central for one in flown):.1f} %"
