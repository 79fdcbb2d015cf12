"""A policy by its name, made afresh for every mission, and how it is flown."""

from collections.abc import Callable
from dataclasses import dataclass

from planner import Problem
from studies.central import CentralDecider, Policy


@dataclass(frozen=True, slots=True)
class Contender:
    """What is compared: `fresh` makes the policy for one mission.

    It sees what is expected from periods and means, with `futures` so many ways how it may come, too; the truth
    without `forecast`. One that is not `lawful` ignores the constraints.
    """

    name: str
    fresh: Callable[[Problem], Policy]
    forecast: bool = True
    futures: int = 0
    lawful: bool = True

    def fly(self, mission: Problem, horizon: int) -> tuple[tuple[int, ...], Policy]:
        """Fly a mission with windows of `horizon` messages; return what was sent and the policy that flew it."""
        policy = self.fresh(mission)
        decider = CentralDecider(mission, horizon, forecast=self.forecast, futures=self.futures)
        return decider.fly(policy), policy
