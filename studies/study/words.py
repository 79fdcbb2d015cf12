"""What the results mean, in words: every number and every claim is computed from the records."""

from collections.abc import Iterator, Sequence
from statistics import fmean
from typing import TypeVar

from studies.simulation.team import DECISION_TIME
from studies.study.characteristic import Characteristic
from studies.study.contenders import TITLES
from studies.study.measures import (
    SATURATED,
    agreement,
    ahead_of,
    binds,
    by_level,
    curve,
    gains_of,
    real_flights,
    saturated,
    shares_by_limit,
    swept,
)
from studies.study.programme import CARRIED, SCENARIOS, Extent, Sweep, everything
from studies.study.results import Results

GOAL = 0.95
"""The part of the bound that best mode is to reach at every limit."""
CLOSE = 0.02
"""Networks agree that lie no farther apart than this; a line is flat that moves no more [shares]."""
NAMED = 5
"""So many points of a curve are named."""
OURS = ("paper-alone", "paper")
"""Who stands for the method of the paper, the first who flew."""

T = TypeVar("T")


def flown(results: Results, extent: Extent) -> str:
    """Say what was flown and how."""
    tasks = everything(extent)
    known = len(results.store.of(tasks))
    missing = f" **{len(tasks) - known:,} of them are not flown yet.**" if known < len(tasks) else ""
    part = "" if extent.name == "full" else " This is not the full study: `make study` flies that."
    return (
        f"{len(tasks):,} flights.{missing}{part} Missions are those of §4.2: ten robots, one stream of 2,048-byte"
        f" messages each at about 1 Hz, {extent.seconds:g} s, {extent.seeds} missions of each kind, limits of"
        f" {_span(extent.limits)} messages in 2.5 s, of about 25 that are generated. Where nothing else is said"
        " each robot decides alone, with what it heard over ns-3's 802.11b at 5.5 Mbit/s, ad hoc, by UDP broadcast."
        f" What is decided goes {1e3 * DECISION_TIME:g} ms later, whoever decides."
        " The bound is the linear programme of the same mission, which knows everything beforehand, at the latency that"
        " messages have on that network."
    )


def figure_3(results: Results, extent: Extent) -> Iterator[str]:
    """Say what Fig. 3 shows."""
    yield (
        "Above: utility of what was received, as a part of what all messages without delay would be worth, by the"
        " messages sent. Below: what the messages sent at random gained per second of use (§4.1), as parts of the"
        " greatest, as a histogram and summed up (eCDF)."
    )
    for scenario, title in SCENARIOS.items():
        found = [
            f"{100 * best:.0f} % by {100 * sent:.0f} % of messages (random dropping {100 * random:.0f} %)"
            for sent, best, random in _some(list(_beside_random(results, extent, scenario, "best")))
        ]
        gained = gains_of(results, extent, scenario)
        said = [f"best mode reaches {', '.join(found)} of the maximum"] if found else []
        if any(gained):
            parts = Characteristic.of(gained).levels.items()
            levels = ", ".join(f"{100 * part:.0f} % have {level}" for level, part in parts)
            said.append(f"of the messages {levels} utility")
        yield f"*{title}*: {'; '.join(said)}." if said else f"*{title}*: nobody dropped messages at random."


def _some(points: Sequence[T]) -> list[T]:
    """Return a few points from the first to the last: more than these nobody reads in a sentence."""
    places = {round(part * (len(points) - 1) / (NAMED - 1)) for part in range(NAMED)} if points else set()
    return [points[at] for at in sorted(places)]


def contenders(results: Results, extent: Extent) -> Iterator[str]:
    """Say how the contenders compare."""
    for scenario, title in SCENARIOS.items():
        best = shares_by_limit(results, extent, "best", scenario)
        if not best:
            continue
        free = [level for level in best if not _full(results, extent, scenario, level)]
        reached = [level for level in free if best[level].mean >= GOAL]
        least = min(free, key=lambda level: best[level].mean, default=None)
        short = f"; the least is {best[least].percent()} % at {least:g}" if least is not None else ""
        yield (
            f"*{title}*: best mode reaches {100 * GOAL:g} % of the bound at {len(reached)} of the {len(free)} limits at"
            f" which the channel is not saturated{short}."
        )
        yield "\n".join(_beside(results, extent, scenario))


def _beside(results: Results, extent: Extent, scenario: str) -> Iterator[str]:
    """Yield a line for each other contender: where best mode is ahead, mission by mission."""
    for name in extent.flying:
        if name == "best" or not shares_by_limit(results, extent, name, scenario):
            continue
        pairs = list(ahead_of(results, extent, "best", name, scenario))
        bound = [(level, mean) for level, mean in pairs if binds(results, extent, scenario, level)]
        if not bound:
            continue
        ahead = sum(mean.above_nothing for _, mean in bound)
        behind = [f"{level:g} ({mean.percent()})" for level, mean in bound if mean.below_nothing]
        lower = [(mean.mean, level, mean) for level, mean in bound if mean.mean < 0 and not mean.below_nothing]
        _, level, least = min(lower, default=(0.0, 0.0, None))
        average = fmean(mean.mean for _, mean in bound)
        yield (
            f"- {TITLES[name]}: best mode is {100 * average:+.1f} points ahead by the mean of {len(bound)} limits that"
            f" bind; beyond the confidence interval it is ahead at {ahead}"
            + (f", behind at {', '.join(behind)}" if behind else ", behind at none")
            + (f"; it is behind within it at {len(lower)}, most at {level:g} ({least.percent()})" if least else "")
            + "."
        )


def networks(results: Results, extent: Extent) -> Iterator[str]:
    """Say whether our own medium agrees with ns-3."""
    cells = agreement(results, extent)
    for ns3, own, what in (("adhoc", "own", "broadcast"), ("infrastructure", "own, unicast", "unicast")):
        free = {place: each for place, each in cells.items() if each[ns3][1] >= SATURATED}
        if not free:
            yield f"By {what} the channel was saturated in all missions, so there is nothing to compare."
            continue
        apart = {place: each[own][0] - each[ns3][0] for place, each in free.items()}
        (scenario, level), worst = max(apart.items(), key=lambda each: abs(each[1]))
        agree = sum(abs(each) <= CLOSE for each in apart.values())
        yield (
            f"By {what} best mode reaches the same within {100 * CLOSE:g} points of the bound over both networks at"
            f" {agree} of {len(free)} points where the channel is not saturated (of {len(cells)}); they are farthest"
            f" apart at {SCENARIOS[scenario]}, {level:g} in 2.5 s: {100 * worst:+.1f} points over our own medium."
        )


def sweep(results: Results, extent: Extent, varied: Sweep) -> str:
    """Say what a sweep shows: the range of each line, and where it is flat."""
    lines = []
    for title, points in swept(results, extent, varied).items():
        if not points:
            continue
        low, high = min(points, key=lambda x: points[x].mean), max(points, key=lambda x: points[x].mean)
        said = f"from {points[low].percent()} % (at {low:g}) to {points[high].percent()} % (at {high:g})"
        begin, end = varied.flat or (min(points), max(points))
        within = [points[x].mean for x in points if begin <= x <= end]
        if within and (varied.flat is not None or max(within) - min(within) <= CLOSE):
            said += f"; between {begin:g} and {end:g} it moves by {100 * (max(within) - min(within)):.1f} points"
        lines.append(f"*{title}*: {said}.")
    return " ".join(lines)


def real_traffic(results: Results, extent: Extent) -> Iterator[str]:
    """Say what real traffic reaches, and beside whom."""
    yield (
        f"What robots really send, in missions of {extent.real_seconds:g} s ({extent.real_seeds} of each). *Mixed* is"
        " a camera of 26 kB at 10 Hz beside odometry, telemetry, a log and alarms, *random* samples of 1 to 40 kB at"
        " any time, each with 1 Mbit/s for all; *cameras* see red now and then, with 2.7 Mbit/s, and in"
        " *cameras-current* it costs to show what is no longer there; *crowd* are small streams of all rates. The bound"
        " is the linear programme with all small samples sent."
    )
    flown_by = real_flights(results, extent)
    for network, what in CARRIED.items():
        said = []
        for (workload, _), flights in flown_by.items():
            best = results.mean(flights.get(("best", network), ()), results.share)
            if best is None:
                continue
            others = {
                name: mean
                for (name, of), tasks in flights.items()
                if name != "best" and of == network
                if (mean := results.mean(tasks, results.share)) is not None
            }
            beside = ", ".join(f"{TITLES[name]} {mean.percent()}" for name, mean in others.items())
            said.append(f"{best.percent()} % of the bound in *{workload}* ({beside})")
        if said:
            yield f"{what.capitalize()} best mode reaches {'; '.join(said)}."


def beside_the_paper(results: Results, extent: Extent) -> Iterator[str]:
    """Say what agrees with the paper's words on Fig. 3, and what does not."""
    ours = next((name for name in OURS if name in extent.flying), "best")
    leads = {scenario: _lead(results, extent, scenario, ours) for scenario in SCENARIOS}
    known = {scenario: lead for scenario, lead in leads.items() if lead is not None}
    if len(known) == len(SCENARIOS):
        yield (
            f"By the mean of its levels {TITLES[ours]} is ahead of random dropping, at equal numbers of messages, by "
            + ", ".join(f"{100 * lead:+.0f} points ({SCENARIOS[scenario]})" for scenario, lead in known.items())
            + " of the maximum."
        )
        order = known["most"] <= known["mixed"] <= known["few"]
        yield _claim(
            "the fewer messages are important the more there is to gain by planning, (a) least, (b) between, (c) most",
            order,
        )
        yield _claim("in (c), few important, the method does very much better than random", known["few"] > 0.1)
        yield _claim("in (a), most important, it cannot do much better than random", known["most"] < 0.1)
    yield (
        "What differs from the paper by intent. The weights of scenarios (a) and (c) are swapped in its text; here they"
        " go by their characteristic. Its frames went at the lowest basic rate, 1 Mbit/s, for broadcasts do so in ns-3"
        " unless they are told otherwise; here they go at 5.5 Mbit/s. Its senders start in the same instant and"
        " collide; here each waits up to a millisecond. Utility is counted after ten seconds of warm-up. Its limits"
        " count messages in 2.5 s, as here. Forecasts know only what a robot could have seen by then;"
        " `results/foresight.md` says what more would be worth, and `results/paper_mode.md` what paper mode does"
        " otherwise than §3."
    )


def _claim(text: str, holds: bool) -> str:  # noqa: FBT001 -- that is what a claim has
    return f"- The paper says: {text}. {'Here, too.' if holds else '**Not here.**'}"


def _lead(results: Results, extent: Extent, scenario: str, contender: str) -> float | None:
    points = [ours - random for _, ours, random in _beside_random(results, extent, scenario, contender)]
    return fmean(points) if points else None


def _beside_random(
    results: Results, extent: Extent, scenario: str, contender: str
) -> Iterator[tuple[float, float, float]]:
    """Yield what is sent, what the contender reaches, and what random dropping would by as many messages."""
    dropping = curve(results, extent, "random", scenario)
    for sent, reached in curve(results, extent, contender, scenario).means:
        random = dropping.at(sent)
        if random is not None:
            yield sent, reached.mean, random


def _full(results: Results, extent: Extent, scenario: str, level: float) -> bool:
    return any(saturated(results, task) for task in by_level(extent, "best", scenario).get(level, []))


def _span(values: tuple[float, ...]) -> str:
    return f"{min(values):g} to {max(values):g} ({len(values)} of them)"
