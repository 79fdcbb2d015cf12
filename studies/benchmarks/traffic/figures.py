"""What a flight was: its figures, from what was published, what arrived and what crossed between the robots."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner import Problem
from planner.definition import utility
from planner.utility import Floats
from studies.benchmarks.traffic.flight import Flight, Name
from studies.benchmarks.traffic.problem import published
from studies.demo.layout import OPERATOR
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.plan import best_plan
from studies.simulation.traffic.scores import LONG
from studies.simulation.traffic.workloads import Workload

WARM_UP = 3.0
"""Flown but not scored [s]."""
EXACT = 0.002
"""Windows are taken this much shorter [s]: so long it may take from when a daemon forwards until the link has it."""


@dataclass(frozen=True, slots=True)
class Ages:
    """Of samples: how many were published and arrived, and their ages at arrival: median and 95th percentile [s]."""

    published: int
    arrived: int
    p50: float
    p95: float

    @property
    def share(self) -> float:
        """What part arrived."""
        return self.arrived / self.published if self.published else 1.0


@dataclass(frozen=True, slots=True)
class Figures:
    """Of a flight after the warm-up. `over` is the part of windows over the limit, `worst` the fullest one in limits.

    `sustained` is what the fullest 10 s hold, as a part of what the limit allows in that time. `sent` are bytes of
    samples, `told` what daemons tell each other and `framing` what Zenoh adds to samples, both in B/s; `processor` is
    what each daemon takes for a sample of its robot (the operator's: for one that comes) [s]. `late` is how much later
    than due applications published, at the 99th percentile [s].
    """

    kinds: Mapping[str, Ages]
    small: Ages
    sent: float
    over: float
    worst: float
    sustained: float
    told: float
    framing: float
    processor: Mapping[str, float]
    late: float

    @property
    def robots(self) -> float:
        """What the daemons of robots take of the processor for a sample, in the mean [s]."""
        return float(np.mean([taken for name, taken in self.processor.items() if name != OPERATOR]))


def figures(flight: Flight, workload: Workload) -> Figures:
    """Compute the figures of a flight."""
    crossed = [each for each in flight.crossed if WARM_UP <= each[0] < flight.seconds]
    sent = sum(sample[3] for each in crossed for sample in each[5])
    wire, told = sum(each[3] for each in crossed), sum(each[4] for each in crossed)
    windows = _windows(flight, workload.window - EXACT) / (workload.rate * workload.window)
    return Figures(
        kinds={kind.name: _ages(flight, workload, (kind,)) for kind in workload.kinds},
        small=_ages(flight, workload, tuple(kind for kind in workload.kinds if kind.small)),
        sent=float(sent),
        over=float(np.mean(windows > 1.0)) if len(windows) else 0.0,
        worst=float(windows.max(initial=0.0)),
        sustained=float(_windows(flight, LONG - EXACT).max(initial=0.0) / (workload.rate * LONG)),
        told=told / (flight.seconds - WARM_UP),
        framing=(wire - told - sent) / (flight.seconds - WARM_UP),
        processor=_processor(flight),
        late=float(np.percentile([each.t_gen - each.due for each in flight.published.values()], 99)),
    )


@dataclass(frozen=True, slots=True)
class Worth:
    """What the operator got, or could have got [utility·s]: of everything, and of all but alarms."""

    everything: float
    others: float


@dataclass(frozen=True, slots=True)
class Best:
    """What the best plan found is worth, its bytes after the warm-up, and what it lacks of a bound, as a part."""

    worth: Worth
    size: float
    gap: float


def reached(flight: Flight, workload: Workload) -> Worth:
    """What the operator got."""
    problem, names = published(flight, workload)
    arrived = [i for i, name in enumerate(names) if name in flight.received]
    messages = list(problem.messages)
    for i in arrived:
        messages[i] = messages[i]._replace(t_rcv=flight.received[names[i]])
    return _worth(_scored(replace(problem, messages=tuple(messages))), arrived, names, workload)


def best(flight: Flight, workload: Workload, time_limit: float) -> Best:
    """Return the best that could have been made of what was published, as far as it is found in `time_limit` [s]."""
    problem, names = published(flight, workload)
    problem = _scored(problem)
    small = [i for i, name in enumerate(names) if _kind(name, workload).small]
    plan = best_plan(problem, certain=small, since=WARM_UP, time_limit=time_limit)
    return Best(_worth(problem, plan.sends, names, workload), plan.bytes, plan.gap)


def _worth(problem: Problem, sends: Sequence[int], names: Sequence[Name], workload: Workload) -> Worth:
    others = [i for i in sends if not _kind(names[i], workload).alarm]
    return Worth(utility(problem, sends), utility(problem, others))


def _kind(name: Name, workload: Workload) -> Kind:
    return workload.robots[name[0]][name[1]]


def _scored(problem: Problem) -> Problem:
    """Return it as it is scored: what was received before the end of the warm-up counts from then on."""
    return replace(problem, messages=tuple(m._replace(t_rcv=max(m.t_rcv, WARM_UP)) for m in problem.messages))


def _ages(flight: Flight, workload: Workload, kinds: tuple[Kind, ...]) -> Ages:
    """Of the samples of some kinds; the last ones may still be on their way at the end."""

    def counts(name: Name) -> bool:
        return _kind(name, workload) in kinds and flight.published[name].t_gen >= WARM_UP

    names = [name for name in flight.published if counts(name)]
    ages = [flight.received[name] - flight.published[name].t_gen for name in names if name in flight.received]
    p50, p95 = np.percentile(ages, (50, 95)) if ages else (np.nan, np.nan)
    return Ages(len(names), len(ages), float(p50), float(p95))


def _windows(flight: Flight, window: float) -> Floats:
    """Return what each window holds that ends with a send after the warm-up: samples, and what daemons tell [B]."""
    sends = [(each[0], each[4] + sum(sample[3] for sample in each[5])) for each in flight.crossed]
    sends = [send for send in sends if send[1]]
    times, sizes = np.array([t for t, _ in sends]), np.array([size for _, size in sends], dtype=np.float64)
    total = np.append(0.0, np.cumsum(sizes))
    first = np.searchsorted(times, times - window, "left")
    last = np.searchsorted(times, times, "right")
    inside = (times >= WARM_UP) & (times < flight.seconds)
    return np.asarray((total[last] - total[first])[inside])


def _processor(flight: Flight) -> dict[str, float]:
    of = [name[0] for name in flight.published]
    samples = {f"r{robot + 1}": of.count(robot) for robot in set(of)} | {OPERATOR: len(flight.received)}
    return {name: flight.processor[name] / max(count, 1) for name, count in samples.items()}
