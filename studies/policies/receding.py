"""The exact receding-horizon optimiser: the proven optimum of every window, whatever it costs."""

from dataclasses import dataclass, field, replace

import planner
from planner import Problem, SearchSettings
from studies.oracle import optimum

NODES = 2**22
"""Room for the search, so that it ends with a proof and not with a full tree."""


@dataclass(slots=True)
class Receding:
    """Send when the proven optimum of the window does.

    With `beyond` it is that of best mode's objective, else that of U of the window alone. Best mode's search proves
    it, mostly within a few hundred iterations. After `budget` [iterations] without proof HiGHS takes over for U, for
    at most `patience` [s]; the objective is left to the search. `unproven` counts the windows without any proof.
    """

    beyond: bool = True
    budget: int = 100_000
    patience: float = 30.0
    unproven: int = field(default=0, init=False)

    def __call__(self, window: Problem) -> bool:
        """Solve the window and return the decision."""
        problem = window if self.beyond else replace(window, goes_on=False)
        search = planner.start(problem, SearchSettings(search="best", max_nodes=NODES))
        search.run(self.budget)
        plan = search.plan()
        if search.done and plan.nodes < NODES:
            return plan.send
        if self.beyond:
            self.unproven += 1
            return plan.send
        solved = optimum(problem, self.patience)
        self.unproven += not solved.exact
        return bool(solved.sends[problem.current] > 0)
