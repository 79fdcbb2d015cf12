"""The paper's search (§3.1), exactly, with what the paper leaves open as stated here.

Selection by UCT (Eq. 3), expansion by both decisions of the next message, no roll-out: the node reached is
scored by Eq. 2. The reduction for Markovian types (§3.2.2) is in `reduction.py`.
"""

import math

from planner.answers import Found, answer
from planner.python_engine.path import Path
from planner.python_engine.prices import Prices
from planner.python_engine.reduction import Reduction
from planner.python_engine.tree import DROP, SEND, Node, Row, ancestors
from planner.search import Plan, SearchSettings
from planner.tables import Tables


class PaperSearch:
    """Grows the tree of §3.1 and answers with the most visited path."""

    def __init__(self, tables: Tables, settings: SearchSettings) -> None:
        self._tables = tables
        self._exploration = settings.exploration
        self._max_nodes = settings.max_nodes
        self._scale: list[float] = tables.scale.tolist()
        self._path = Path(tables)
        self._root = Node(index=0, parent=None, level=0, send=False, utility=tables.gains.facts)
        self._nodes = [self._root]
        self._reduction = (
            None if settings.reduction == "off" else Reduction(self._path, self._scale, settings.reduction)
        )
        self.iterations = 0

    @property
    def done(self) -> bool:
        """Whether the arena is full: then no iteration can grow the tree any more."""
        return len(self._nodes) + 2 > self._max_nodes

    def run(self, iterations: int) -> int:
        """Run at most `iterations` more; return how many ran."""
        ran = 0
        while ran < iterations and not self.done:
            self._iterate()
            ran += 1
        self.iterations += ran
        return ran

    def _iterate(self) -> None:
        node = self._select()
        if node.level < self._tables.levels:
            self._expand(node)
            if self._reduction and self._reduction.cut_if_barren(node):
                return
        score = node.utility / self._scale[node.level]
        for visited in ancestors(node):
            visited.visits += 1
            visited.sum += score

    def _select(self) -> Node:
        """Walk down from the root by the greatest UCT to a node without children."""
        node = self._root
        self._path.reset()
        while node.expanded:
            drop, send = node.children
            if drop is None or (send is not None and self._prefers_send(node, drop, send)):
                node = _existing(send)
            else:
                node = drop
            self._path.step(node.level - 1, send=node.send)
        return node

    def _prefers_send(self, parent: Node, drop: Node, send: Node) -> bool:
        """Whether sending has the greater UCT (Eq. 3); an unvisited child counts as infinite, drop first."""
        if drop.visits == 0 or send.visits == 0:
            return drop.visits > 0
        log_visits = math.log(parent.visits)
        return self._uct(send, log_visits) > self._uct(drop, log_visits)

    def _uct(self, node: Node, log_visits: float) -> float:
        return node.sum / node.visits + self._exploration * math.sqrt(log_visits / node.visits)

    def _expand(self, node: Node) -> None:
        """Create the drop child, and the send child unless it breaks a constraint."""
        node.expanded = True
        self._create(node, send=False, utility=node.utility)
        if self._path.fits(node.level):
            self._create(node, send=True, utility=node.utility + self._path.gain(node.level))

    def _create(self, parent: Node, *, send: bool, utility: float) -> None:
        child = Node(index=len(self._nodes), parent=parent, level=parent.level + 1, send=send, utility=utility)
        if self._reduction and not self._reduction.admit(child):
            return
        self._nodes.append(child)
        parent.children[SEND if send else DROP] = child
        if self._reduction:
            self._reduction.enter(child)

    def plan(self) -> Plan:
        """Answer with the most visited path; drop when it does not reach the current message."""
        current = self._tables.current
        path = [self._root, *_most_visited_below(self._root)]
        send = len(path) > current + 1 and path[current + 1].send
        other = path[current].children[DROP if send else SEND] if len(path) > current + 1 else None
        opposite = [*path[: current + 1], other, *_most_visited_below(other)] if other else None
        prices = self._prices(path[-1].utility)
        found = Found(
            sends=_sends(path),
            opposite=None if opposite is None else _sends(opposite),
            bound=prices.bound if self._tables.gains.closed else None,
            asked=prices.asked(current),
            nodes=len(self._nodes),
        )
        return answer(self._tables, found, self.iterations)

    def _prices(self, reached: float) -> Prices:
        """Return the prices that best mode would learn, to explain a plan that has `reached` a utility [utility·s]."""
        prices = Prices(self._tables, Path(self._tables))
        while prices.learning:
            prices.learn(prices.relax(), reached)
        return prices

    def tree(self) -> list[Row]:
        """Every node in the order of creation, to compare engines."""
        return [node.row() for node in self._nodes]


def _sends(path: list[Node]) -> list[int]:
    """Return the levels that a path sends."""
    return [node.level - 1 for node in path if node.send]


def _existing(node: Node | None) -> Node:
    if node is None:
        raise AssertionError("an expanded node has a child")
    return node


def _most_visited_below(node: Node) -> list[Node]:
    """Return the path of most visits below a node; ties: drop."""
    path = []
    while any(node.children):
        drop, send = node.children
        node = _existing(send if drop is None or (send is not None and send.visits > drop.visits) else drop)
        path.append(node)
    return path
