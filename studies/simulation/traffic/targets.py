"""What is asked of teams in real traffic, and what the flights that were flown show of it."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

from studies.benchmarks.report import Table
from studies.simulation.traffic.comparison import PLAN, SIMPLE, USUAL, YARDSTICKS, Result
from studies.simulation.traffic.marks import Marks
from studies.simulation.traffic.missions import UNIFORM
from studies.simulation.traffic.scores import Score

Row = tuple[str, str, str, str]
SOON, LATE, SELDOM = 0.1, 0.3, 0.01
"""Latencies up to the first [s] and losses up to the last are ordinary; from the second latency on news are late."""
MAY_EXCEED = 1.1
"""By so many limits, or by one message, windows may."""
CONTESTED = ("random", "cameras", "cameras-current", "crowd")


@dataclass(frozen=True, slots=True)
class Group:
    """The flights of one contender under the same conditions, with different seeds."""

    results: tuple[Result, ...]

    @property
    def contender(self) -> str:
        """Who flew."""
        return self.results[0].task.contender

    @property
    def workload(self) -> str:
        """What was flown."""
        return self.results[0].task.cell.workload

    @property
    def label(self) -> str:
        """Under which conditions."""
        return self.results[0].task.cell.label

    @property
    def latency(self) -> float:
        """Of every sample [s]."""
        return self.results[0].task.cell.latency

    @property
    def loss(self) -> float:
        """Part of all samples and digests that is lost."""
        return self.results[0].task.cell.loss

    @property
    def scores(self) -> list[Score]:
        """What was reached, by seed."""
        return [result.score for result in self.results if result.score is not None]


def target_table(results: Sequence[Result]) -> Table:
    """Return a row for each target and team that anything was flown for, with the worst that was measured."""
    groups, marks = _groups(results), Marks(results)
    deciders = [group for group in groups if group.contender == "central"]
    teams: dict[str, list[Group]] = {}
    for group in groups:
        if group.contender not in (*YARDSTICKS, PLAN):
            teams.setdefault(group.contender, []).append(group)
    rows = [*_central(deciders, groups, marks)]
    for team, flown in teams.items():
        rows += [(f"{team}: {what}", asked, found, met) for what, asked, found, met in _team(flown, groups, marks)]
    return Table("Targets", ("what", "asked", "measured at worst", "met"), tuple(rows), "Means over seeds.")


def _groups(results: Iterable[Result]) -> list[Group]:
    found: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        found.setdefault((result.task.cell.label, result.task.contender), []).append(result)
    return [Group(tuple(each)) for each in found.values()]


def _central(deciders: Sequence[Group], groups: Sequence[Group], marks: Marks) -> Iterator[Row]:
    ordinary = [group for group in deciders if _ordinary(group) and group.workload in CONTESTED]
    yield from _least("central: of the bound", 0.90, ordinary, lambda group: _mean(marks.of_bound, group))
    yield from _least("central: beside greedy", 1.0, deciders, lambda group: _beside(group, groups, ("greedy",)))


def _team(flown: Sequence[Group], groups: Sequence[Group], marks: Marks) -> Iterator[Row]:
    """Yield what is asked of every team."""

    def of_central(group: Group) -> float | None:
        return _mean(marks.of_central, group)

    contested = [group for group in flown if group.workload in CONTESTED and group.loss <= SELDOM]
    alike = [group for group in flown if group.workload.startswith(UNIFORM) and group.loss <= SELDOM]
    lossy = [g for g in flown if g.loss > SELDOM and g.latency == USUAL[0] and g.contender.endswith("broadcast")]
    mixed = [group for group in flown if group.workload == "mixed" and _ordinary(group)]
    yield from _least("contested, to 100 ms: of central", 0.95, filter(_ordinary, contested), of_central)
    yield from _least("contested, from 300 ms: of central", 0.85, _late(contested), of_central)
    yield from _most("windows over", 0.01, filter(_ordinary, flown), lambda group: fmean(s.over for s in group.scores))
    yield from _most("windows over, from 300 ms", 0.0, _late(flown), lambda group: fmean(s.over for s in group.scores))
    yield from _most("fullest window, beside 1.1 limits or a message more than one", 1.0, flown, _fullest)
    yield from _least("uniform, to 100 ms: of central", 0.96, filter(_ordinary, alike), of_central)
    yield from _least("uniform, every latency: of central", 0.92, alike, of_central)
    yield from _neighbours(alike, of_central)
    yield from _least("loss of 10 %: of central", 0.95, lossy, of_central)
    yield from _most("loss of 10 %: windows over", 0.03, lossy, lambda group: fmean(s.over for s in group.scores))
    yield from _least("mixed: bytes of the best plan", 0.92, mixed, lambda group: _of_plan(group, groups))
    yield from _least("mixed: small samples sent", 0.99, mixed, lambda group: fmean(s.kept for s in group.scores))
    yield from _least("mixed: alarms sent", 1.0, mixed, _alarms)
    yield from _most("told, of what may be", 1.0, flown, lambda group: fmean(s.told / s.allowed for s in group.scores))
    yield from _least(
        "beside policies that keep the limit", 1.0, flown, lambda group: _beside(group, groups, tuple(SIMPLE))
    )


def _ordinary(group: Group) -> bool:
    return group.latency <= SOON and group.loss <= SELDOM


def _late(groups: Iterable[Group]) -> list[Group]:
    return [group for group in groups if group.latency >= LATE and group.loss <= SELDOM]


Measure = Callable[[Group], float | None]


def _least(what: str, asked: float, groups: Iterable[Group], measure: Measure) -> Iterator[Row]:
    """Yield the row of something that should be at least so much, if anybody flew for it."""
    found = [(value, group.label) for group in groups if (value := measure(group)) is not None]
    if found:
        worst, label = min(found)
        yield what, f"≥ {100 * asked:g} %", f"{100 * worst:.1f} % ({label})", _met(worst >= asked)


def _most(what: str, asked: float, groups: Iterable[Group], measure: Measure) -> Iterator[Row]:
    found = [(value, group.label) for group in groups if (value := measure(group)) is not None]
    if found:
        worst, label = max(found)
        yield what, f"≤ {100 * asked:g} %", f"{100 * worst:.1f} % ({label})", _met(worst <= asked)


def _neighbours(alike: Sequence[Group], measure: Measure) -> Iterator[Row]:
    """Yield by how much a latency is worse than the next ones, where all else is the same."""
    found = []
    for workload in dict.fromkeys(group.workload for group in alike):
        own = sorted(
            (group.latency, 100 * share)
            for group in alike
            if group.workload == workload and group.loss == USUAL[1] and (share := measure(group)) is not None
        )
        found += [
            (abs(after - before), f"{workload} {1000 * later:g} ms") for (_, before), (later, after) in pairwise(own)
        ]
    if found:
        worst, label = max(found)
        yield "uniform, beside the next latency", "≤ 2 points", f"{worst:.1f} points ({label})", _met(worst <= 2.0)


def _mean(share: Callable[[Result], float | None], group: Group) -> float | None:
    shares = [each for result in group.results if (each := share(result)) is not None]
    return fmean(shares) if shares else None


def _beside(group: Group, groups: Sequence[Group], names: tuple[str, ...]) -> float | None:
    """Return the utility as a part of the best of these policies' that keep the limit, under the same conditions."""
    rivals = [each for each in groups if each.label == group.label and each.contender in names]
    lawful = [each for each in rivals if max(score.over for score in each.scores) == 0.0]
    best = max((_utility(each) for each in lawful), default=0.0)
    return _utility(group) / best if best else None


def _utility(group: Group) -> float:
    return fmean(result.utility for result in group.results)


def _of_plan(group: Group, groups: Sequence[Group]) -> float | None:
    """Return the bytes sent as a part of the best plan's, of the same missions."""
    plans = {
        (each.workload, result.task.cell.robots, each.latency, result.task.cell.seed): result.sent
        for each in groups
        if each.contender == PLAN
        for result in each.results
    }
    parts = []
    for result in group.results:
        plan = plans.get((group.workload, result.task.cell.robots, group.latency, result.task.cell.seed))
        if plan:
            parts.append(result.sent / plan)
    return fmean(parts) if parts else None


def _fullest(group: Group) -> float:
    return max(score.worst / max(MAY_EXCEED, 1.0 + score.largest) for score in group.scores)


def _alarms(group: Group) -> float | None:
    generated = sum(score.alarms for score in group.scores)
    return sum(score.alarms_sent for score in group.scores) / generated if generated else None


def _met(holds: bool) -> str:  # noqa: FBT001 -- it is the only argument
    return "yes" if holds else "no"
