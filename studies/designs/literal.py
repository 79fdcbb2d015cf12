"""Paper mode with one thing or several as §3 of the paper says them, where the planner does otherwise.

`planner/README.md` names these deviations, `studies.benchmarks.deviations` says what each is worth.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from planner import Message, Problem, SearchSettings
from planner.definition import utility
from planner.native_engine import NativeSearch
from planner.numpy_tables import SHORTEST_PROGRESS, NumpyTables, tabulate_with_numpy
from planner.python_engine.tree import Node, ancestors
from planner.utility import Floats
from studies.designs.paper import Paper


class NewChild(Paper):
    """A new child of the node reached is made and scored, in place of the node itself (Supplementary Appendix A)."""

    def _iterate(self) -> None:
        node = self._select()
        if node.level < self._tables.levels and (node.visits or node.parent is None):
            self._expand(node)
            node = node.living_children()[0]
        score = node.utility / self._scale[node.level]
        for visited in ancestors(node):
            visited.visits += 1
            visited.sum += score


class DescendantsAlone(Paper):
    """The mean score in Eq. 3 is that of the descendants of a node, without its own."""

    def _uct(self, node: Node, log_visits: float) -> float:
        if node.visits == 1:
            return super()._uct(node, log_visits)
        own = node.utility / self._scale[node.level]
        return (node.sum - own) / (node.visits - 1) + self._exploration * float(np.sqrt(log_visits / node.visits))


@dataclass(slots=True)
class Literal:
    """Flies one mission by paper mode with some things to the letter; all are off by default.

    `to_the_end`: utility is counted to the end of the mission, not of the window, and ψ is t over that.
    `whole` also: U(M) is of all messages of the mission, and M_v what was sent since its start (Eq. 2).
    `considered`: ψ is that of the message decided last, the one "considered in v", not of the next one.
    `floor` off: ψ may be as small as it likes. `search` is one of the classes above in place of the native engine.
    Without `stretched` a message that exceeds a limit is never sent (Eq. 5), nor planned for.
    """

    mission: Problem
    settings: SearchSettings
    iterations: int
    to_the_end: bool = False
    whole: bool = False
    considered: bool = False
    floor: bool = True
    stretched: bool = True
    search: type[Paper] | None = None
    _sent: list[Message] = field(default_factory=list)
    _decided: int = 0
    _everything: float = 0.0

    def __post_init__(self) -> None:
        self._everything = utility(self.mission, range(len(self.mission.messages))) if self.whole else 0.0

    def __call__(self, window: Problem) -> bool:
        """Search the window and return the decision; windows come in the order of the mission."""
        send = (self.stretched or self._may_fit(window.messages[window.current])) and self._search(window)
        if send:
            self._sent.append(self.mission.messages[self._decided]._replace(sent=True))
        self._decided += 1
        return send

    def _search(self, window: Problem) -> bool:
        problem = self._problem(window)
        tables = tabulate_with_numpy(problem)
        tables = replace(tables, scale=self._scale_of(problem, tables))
        search = NativeSearch(tables, self.settings) if self.search is None else self.search(tables, self.settings)
        search.run(self.iterations)
        return search.plan().send

    def _problem(self, window: Problem) -> Problem:
        facts = window.messages[: window.current]
        ahead = window.messages[window.current :]
        if not self.stretched:
            ahead = tuple(filter(self._may_fit, ahead))
        if self.whole:
            facts = tuple(self._sent)
        t_end = self.mission.t_end if self.to_the_end or self.whole else window.t_end
        return replace(window, messages=(*facts, *ahead), current=len(facts), t_end=t_end)

    def _may_fit(self, message: Message) -> bool:
        pairs = zip(message.use, self.mission.constraints, strict=True)
        return all(use <= constraint.limit for use, constraint in pairs)

    def _scale_of(self, problem: Problem, tables: NumpyTables) -> Floats:
        """ψ·U(M) for every level, as `planner.numpy_tables` has it, or as Eq. 2 and the text below it say."""
        times = problem.columns.t_gen[problem.columns.opened]
        at = np.append(times[:1], times) if self.considered else np.append(times, problem.t_end)
        since = at - problem.t_start
        progress = np.maximum(since, SHORTEST_PROGRESS) if self.floor else since
        everything = self._everything if self.whole else tables.gains.everything
        scale = progress / (problem.t_end - problem.t_start) * everything
        return np.where(scale >= np.finfo(np.float64).tiny, scale, np.inf)
