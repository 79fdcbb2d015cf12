"""The decision tree: one node for every prefix of decisions that was looked at."""

from collections.abc import Iterator
from dataclasses import dataclass, field

DROP, SEND = 0, 1
"""Where the children of a node stand."""

CUT = -2
"""What a cut node names as its parent in a row; the root names −1."""

Row = tuple[int, int, int, int, float, float]
"""A node to compare engines: index of the parent, level, decision, visits, sum, utility."""


@dataclass(slots=True, eq=False)
class Node:
    """The first `level` messages are decided; the last of them by `send`.

    `utility` is U of the facts and of what the path sends [utility·s]; `sum` adds up the scores of all
    visits.
    """

    index: int
    parent: "Node | None"
    level: int
    send: bool
    utility: float
    visits: int = 0
    sum: float = 0.0
    expanded: bool = False
    alive: bool = True
    children: list["Node | None"] = field(default_factory=lambda: [None, None])

    def living_children(self) -> list["Node"]:
        """Return the children there are: drop before send."""
        return [child for child in self.children if child is not None]

    def row(self) -> Row:
        """Return the node as numbers."""
        parent = self.parent.index if self.parent else -1
        return (
            parent if self.alive else CUT,
            self.level,
            int(self.send),
            self.visits,
            self.sum,
            self.utility,
        )


def ancestors(node: Node | None) -> Iterator[Node]:
    """Yield the node, its parent, and so on to the root."""
    while node is not None:
        yield node
        node = node.parent


def subtree(node: Node) -> list[Node]:
    """Return the node and all below it, parents before children, drop before send."""
    found, waiting = [], [node]
    while waiting:
        found.append(waiting.pop())
        waiting += reversed(found[-1].living_children())
    return found


def detach(node: Node) -> None:
    """Take a node out of the tree: its visits and its sum leave its ancestors."""
    for ancestor in ancestors(node.parent):
        ancestor.visits -= node.visits
        ancestor.sum -= node.sum
    if node.parent is not None:
        node.parent.children[node.send] = None
    node.parent = None
    node.alive = False
