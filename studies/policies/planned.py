"""The planner as a policy."""

from dataclasses import dataclass

import planner
from planner import Plan, Problem, SearchSettings
from studies.central import Uncertain


@dataclass(frozen=True, slots=True)
class Planned:
    """Send when the planner says so after `iterations`.

    In an `Uncertain` window they are shared among its futures; the mean lead decides.
    """

    settings: SearchSettings
    iterations: int
    seed: int = 0

    def __call__(self, window: Problem) -> bool:
        """Search the window and return the decision."""
        futures = window.futures if isinstance(window, Uncertain) else ()
        if not futures:
            return self._plan(window, self.iterations).send
        each = max(1, self.iterations // len(futures))
        lead = 0.0
        for future in futures:
            plan = self._plan(future, each)
            if plan.lead is None:  # sending breaks a constraint, which depends on no future
                return plan.send
            lead += plan.lead if plan.send else -plan.lead
        return lead > 0

    def _plan(self, problem: Problem, iterations: int) -> Plan:
        search = planner.start(problem, self.settings, self.seed)
        search.run(iterations)
        return search.plan()
