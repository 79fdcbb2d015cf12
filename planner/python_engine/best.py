"""The default search: a tree search with a good default policy and a bound on what it can still gain.

It differs from the paper's search (§3.1) in what made that one lose:

It maximises the objective of `beyond.py`: U, and what a plan leaves behind at the end of the window. The *value*
of a node is that of the decisions down to it, the rest dropped.

* *Learning.* The first iterations learn the prices that the default policy and the bounds rest on, each of them one
  round of `prices.py` and one whole plan; the very first also decides the current message both ways.
* *Sweep.* The next iterations go down the window once, level by level, with the best few nodes of each (`sweep.py`).
* *Simulation.* From then on every leaf is completed to the end of the window by the default policy of `prices.py`: send
  what fits and has a positive advantage. So each iteration yields a whole plan; the best one is the answer.
* *Selection.* Every node carries a bound that no plan below it exceeds. The search follows the greatest bound
  of what was not tried yet, its *promise*: optimism in place of UCT's square root.
* *Expansion.* All nodes that a simulation passes join the tree, each with the bound of the other decision.
* *Pruning.* What cannot exceed the best plan is not tried; when nothing is left, that plan is proven optimal.
  Where a stream is open ended (`aggregations/custom.py`) bounds are guesses: they order the search, prune nothing.
* *Dominance.* Of two nodes of one level with the same states of the streams and the same contents of the constraint
  windows only that of the greater value lives (§3.2.2 with the paper's third footnote).
"""

import math
from collections.abc import Hashable
from dataclasses import dataclass, field

from planner.answers import Found, answer
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.python_engine.sweep import Sweep
from planner.python_engine.tree import CUT, DROP, SEND
from planner.search import Plan, SearchSettings
from planner.tables import Tables

MARGIN = 1e-9
"""A bound must exceed the best plan by this part of it to be worth a try."""

NOTHING = -math.inf
"""The bound of what does not exist, is not allowed or was tried."""

Row = tuple[int, int, int, float, float, float, float]
"""A node to compare engines: index of the parent, level, decision, value, bound, untried, promise."""


@dataclass(slots=True, eq=False)
class Node:
    """The first `level` messages are decided; the last of them by `send`. All values are in [utility·s].

    No plan below exceeds `bound`, none that takes the `other` decision, not tried yet, exceeds `untried`;
    `promise` is the greatest `untried` of the node and all below it.
    """

    index: int
    parent: "Node | None"
    level: int
    send: bool
    value: float
    bound: float
    untried: float = NOTHING
    other: bool = False
    promise: float = NOTHING
    alive: bool = True
    children: list["Node | None"] = field(default_factory=lambda: [None, None])

    def row(self) -> Row:
        """Return the node as numbers."""
        parent = self.parent.index if self.parent else -1
        return (
            parent if self.alive else CUT,
            self.level,
            int(self.send),
            self.value,
            self.bound,
            self.untried,
            self.promise,
        )


class BestSearch:
    """Grows the tree from the default policy outwards and keeps the best plans found."""

    def __init__(self, tables: Tables, settings: SearchSettings) -> None:
        self._tables = tables
        self._max_nodes = settings.max_nodes
        self._path = Path(tables)
        self._prices = Prices(tables, self._path)
        self._sweep = Sweep(tables, self._path, self._prices)
        self._proven = False
        self._nodes: list[Node] = []
        self._exact = tables.gains.closed
        self._tantamount: dict[tuple[int, tuple[Hashable, ...], tuple[int, ...]], Node] = {}
        self._best: dict[bool, tuple[float, list[int]]] = {False: (NOTHING, []), True: (NOTHING, [])}
        """By the decision about the current message: the best plan found, its value and the levels it sends."""
        self.iterations = 0
        self.done = False

    def run(self, iterations: int) -> int:
        """Run at most `iterations` more; return how many ran (fewer when done)."""
        ran = 0
        while ran < iterations and not self.done:
            self._iterate()
            ran += 1
        self.iterations += ran
        return ran

    def _iterate(self) -> None:
        if self._prices.learning:
            self._learn()
            return
        if not self._sweep.done:
            self._go_down()
            return
        if self._nodes:
            _back_up(self._try_most_promising())
        else:
            self._path.reset()
            root = self._create(None, send=False, value=self._tables.gains.aim_facts, bound=self._prices.bound)
            _back_up(self._simulate(root))
        self.done = self._full() or not self._worth_trying(self._nodes[0].promise)

    def _full(self) -> bool:
        return len(self._nodes) >= self._max_nodes

    def _learn(self) -> None:
        """Do one round; complete both decisions about the current message by the first policy and by the last."""
        first = self._incumbent() == NOTHING
        bound = self._prices.relax()
        self._prices.learn(bound, self._roll_out())
        if first or not self._prices.learning:
            self._roll_out(forced=False)
            self._roll_out(forced=True)
            if self._best[True][0] == NOTHING:
                self._roll_out(forced=True, clear=True)
        self.done = self._proven = not self._prices.learning and not self._worth_trying(self._prices.bound)

    def _go_down(self) -> None:
        """Sweep one level on; at the end keep the best plans, proven where nothing was left out."""
        self._sweep.descend(self._worth_trying)
        if self._sweep.done:
            for place in self._sweep.places:
                self._path.load(place.path)
                self._found(place.value)
            self.done = self._proven = self._exact and self._sweep.whole

    def _roll_out(self, *, forced: bool | None = None, clear: bool = False) -> float:
        """Follow the default policy, with the current decision forced or not; return the best value so far.

        With `clear` nothing open is sent before the current message, so that it has all the room it can have.
        """
        path = self._path
        path.reset()
        value = self._tables.gains.aim_facts
        for level in range(self._tables.levels):
            wanted = self._prices.advantage(level) > 0
            if level == self._tables.current and forced is not None:
                wanted = forced
            elif clear and level < self._tables.current:
                wanted = False
            send = wanted and path.fits(level)
            value += path.gain(level) if send else 0.0
            path.step(level, send=send)
        self._found(value)
        return self._incumbent()

    def _found(self, value: float) -> None:
        """Keep the plan of the path when it is the best of its decision; the first of equals stays."""
        send = self._tables.current in self._path.sends
        if value > self._best[send][0]:
            self._best[send] = (value, list(self._path.sends))

    def _incumbent(self) -> float:
        return max(self._best[False][0], self._best[True][0])

    def _beaten(self) -> float:
        """Return the bound up to which nothing is worth a try."""
        best = self._incumbent()
        return best + MARGIN * abs(best)

    def _worth_trying(self, bound: float) -> bool:
        return bound > (self._beaten() if self._exact else NOTHING)

    def _try_most_promising(self) -> Node:
        """Walk down by the greatest promise to an untried decision, take it; return the last node reached."""
        node = self._nodes[0]
        self._path.reset()
        while True:
            drop, send = (NOTHING if child is None else child.promise for child in node.children)
            if node.untried > max(drop, send):
                return self._take_other(node)
            child = node.children[SEND if send > drop else DROP]
            if child is None:
                raise AssertionError("a promise comes from somewhere")
            self._path.step(node.level, send=child.send)
            node = child

    def _take_other(self, node: Node) -> Node:
        """Take the decision that was not tried and simulate from there, unless it is dominated at once."""
        bound, node.untried = node.untried, NOTHING
        child = self._step(node, send=node.other, bound=bound)
        return self._simulate(child) if child else node

    def _simulate(self, node: Node) -> Node:
        """Complete the plan by the default policy as long as it is worth it; return the last node."""
        while node.level < self._tables.levels:
            if self._full():
                return node
            fits = self._path.fits(node.level)
            send = fits and self._prices.advantage(node.level) > 0
            other = node.bound - self._prices.loss(node.level, send=not send)
            if fits and self._worth_trying(other):
                node.untried, node.other = other, not send
            bound = node.bound - self._prices.loss(node.level, send=send)
            child = self._step(node, send=send, bound=bound) if self._worth_trying(bound) else None
            if child is None:
                return node
            node = child
        self._found(node.value)
        return node

    def _step(self, parent: Node, *, send: bool, bound: float) -> Node | None:
        """Go on to a new child of the node where the path ends; None when a tantamount node is as good."""
        level = parent.level
        value = parent.value + self._path.gain(level) if send else parent.value
        state = (level, self._path.states(level, send=send), self._path.held(level, send=send))
        rival = self._tantamount.get(state)
        if rival is not None:
            if rival.value >= value:
                return None
            self._remove(rival)
        self._path.step(level, send=send)
        child = self._create(parent, send=send, value=value, bound=bound)
        self._tantamount[state] = child
        return child

    def _remove(self, node: Node) -> None:
        """Take a dominated node out of the tree; its better will dominate what is below it, too."""
        if node.parent is not None:
            node.parent.children[node.send] = None
            _back_up(node.parent)
        node.alive = False

    def _create(self, parent: Node | None, *, send: bool, value: float, bound: float) -> Node:
        level = parent.level + 1 if parent else 0
        node = Node(len(self._nodes), parent, level, send, value, bound)
        self._nodes.append(node)
        if parent is not None:
            parent.children[send] = node
        return node

    def plan(self) -> Plan:
        """Answer with the best plan found; nothing is sent before the first iteration."""
        send = self._best[True][0] > self._best[False][0]
        value, opposite = self._best[not send]
        found = Found(
            sends=self._best[send][1],
            opposite=None if value == NOTHING else opposite,
            bound=self._bound() if self._exact else None,
            asked=self._prices.asked(self._tables.current),
            nodes=len(self._nodes),
        )
        return answer(self._tables, found, self.iterations)

    def _bound(self) -> float:
        """Return what no plan exceeds [utility·s]."""
        if self._proven:
            return self._incumbent()
        if not self._nodes or self._full():
            return self._prices.bound
        return max(self._nodes[0].promise, self._incumbent())

    def tree(self) -> list[Row]:
        """Every node in the order of creation, to compare engines."""
        return [node.row() for node in self._nodes]


def _back_up(node: Node | None) -> None:
    """Renew the promises of a node and all its ancestors."""
    while node is not None:
        promises = (child.promise for child in node.children if child is not None)
        node.promise = max(node.untried, *promises, NOTHING)
        node = node.parent
