"""Policies that do not plan as the daemon does, flown over recorded traffic for comparison."""

from collections.abc import Callable, Iterator
from random import Random
from typing import NamedTuple

from planner import Message, Problem, Receiver, Step, Stream
from studies.central import CentralDecider, Policy
from studies.policies import FixedRate, by_rank, filling_interval, send_all, whenever_it_fits
from studies.replay.mission import Mission
from studies.replay.outcomes import LOST, Columns, Outcomes
from studies.replay.samples import Fate, Sample, Told

PLANNER = "planner"
"""The daemon's own: the policy that is no other."""
AHEAD = 60
"""So many samples are known to a policy that looks ahead."""
WORTHLESS = Step(1.0, 1.0)
"""The utility of what no spec covers; it counts for nobody."""


class Offered(NamedTuple):
    """A policy to compare: `fresh` makes it for a mission, and it knows so many samples, with the one to decide."""

    help: str
    fresh: Callable[[Problem], Policy]
    known: int = 1


POLICIES = {
    "fits": Offered("whatever fits when it comes", lambda _: whenever_it_fits),
    "fixed-rate": Offered(
        "each stream at most so often that all fits on average", lambda m: FixedRate(filling_interval(m))
    ),
    "rank": Offered(
        f"what is worth most by the byte of the next {AHEAD} samples, which it knows", lambda _: by_rank, AHEAD
    ),
    "all": Offered("everything, whatever the limits are", lambda _: send_all),
}
"""By name."""


def enter_all(mission: Mission, told: Iterator[Told], origin: float) -> Outcomes:
    """Take in all samples, of which nothing is decided yet; times count from `origin` [s]."""
    outcomes, last = Outcomes(mission), 0.0
    for each in told:
        if isinstance(each, Fate):
            outcomes.note(each)
        elif isinstance(each, Sample):
            last = max(last, each.t - origin)
            outcomes.enter(each, last)
    return outcomes


def fly(outcomes: Outcomes, name: str, end: float, progress: Callable[[float], object], seed: int = 0) -> None:
    """Let a policy decide everything that was taken in, by `end` [s]; it sends at once. `seed` says what is lost."""
    columns, offered = outcomes.columns(), POLICIES[name]
    problem = problem_of(outcomes, columns, end)
    mission, draw = outcomes.mission, Random(seed)
    policy, decider = offered.fresh(problem), CentralDecider(problem, offered.known)
    for index in range(len(columns.t)):
        stream, t = outcomes.streams[int(columns.stream[index])], float(columns.t[index])
        if stream.planned and not policy(decider.window(index)):
            outcomes.settle(index, f"dropped:{name}")
        else:
            decider.send(index)
            lost = draw.random() < mission.loss
            arrival = LOST if lost else t + mission.latency + float(columns.size[index]) / mission.rate
            outcomes.send(index, t, arrival, "forwarded" if stream.planned else "passed")
        progress(t)


def problem_of(outcomes: Outcomes, columns: Columns, end: float) -> Problem:
    """Return everything that was taken in as one problem, in which each sample arrives once it is published."""
    mission, streams = outcomes.mission, outcomes.streams
    messages = []
    for index in range(len(columns.t)):
        number, t = int(columns.stream[index]), float(columns.t[index])
        stream = streams[number]
        worth = WORTHLESS if stream.covering is None else outcomes.utility(int(columns.worth[index]))
        use = mission.use(int(columns.size[index]), stream.robot)
        t_gen = float(columns.t_gen[index])
        messages.append(Message(number, t_gen, t, t + mission.latency, worth, float(columns.scale[index]), use))
    return Problem(
        tuple(Stream(s.robot, s.aggregation, () if s.covering is None else (Receiver(),)) for s in streams),
        tuple(messages),
        0,
        tuple(limit.constraint for limit in mission.limits),
        (),
        t_start=0.0,
        t_end=end,
    )
