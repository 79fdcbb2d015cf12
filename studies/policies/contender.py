"""A policy by its name, made afresh for every mission, and how it is flown."""

from collections.abc import Callable
from dataclasses import dataclass

from planner import Problem
from studies.central import CentralDecider, Policy
from studies.forecast import Knowledge


@dataclass(frozen=True, slots=True)
class Contender:
    """What is compared: `fresh` makes the policy for one mission.

    It sees what is expected from periods and means so far, with `futures` so many ways how it may come, too; with
    more `knowledge` by a forecast that is a yardstick; the truth without `forecast`. One that is not `lawful` ignores
    the constraints.
    """

    name: str
    fresh: Callable[[Problem], Policy]
    forecast: bool = True
    futures: int = 0
    lawful: bool = True
    knowledge: Knowledge = "seen"

    def fly(self, mission: Problem, horizon: int) -> tuple[tuple[int, ...], Policy]:
        """Fly a mission with windows of `horizon` messages; return what was sent and the policy that flew it."""
        policy = self.fresh(mission)
        decider = CentralDecider(mission, horizon, self.forecast, self.futures, self.knowledge)
        return decider.fly(policy), policy
