"""Reduction for Markovian types (§3.2.2): of tantamount nodes only the one with the greatest utility lives.

`paper` compares the last message of every Markovian stream and the set of messages of the others (Eq. 7), `exact`
also what the constraint windows still hold (the paper's third footnote). When a better node replaces a tantamount one
it takes over what grew below it, with all statistics: utilities shift by the difference, scores by the difference
over ψ·U(M). In `paper` the new place may leave less room in the constraints; what does not fit there is cut.
"""

from collections.abc import Hashable
from typing import Literal

from planner.python_engine.path import Path
from planner.python_engine.tree import Node, ancestors, detach, subtree

State = tuple[int, tuple[Hashable, ...], tuple[int, ...]]


class Reduction:
    """The best node of every state at every level, the set ξ of §3.2.2."""

    def __init__(self, path: Path, scale: list[float], kind: Literal["off", "paper", "exact"]) -> None:
        self._path = path
        self._scale = scale
        self._exact = kind == "exact"
        self._best: dict[State, Node] = {}

    def admit(self, child: Node) -> bool:
        """Whether a new child of the node where the path ends is better than its tantamount node."""
        rival = self._best.get(self._state(child))
        return rival is None or not rival.alive or child.utility > rival.utility

    def enter(self, child: Node) -> None:
        """Make an admitted child the best of its state; it replaces the node that was."""
        state = self._state(child)
        rival = self._best.get(state)
        self._best[state] = child
        if rival is not None and rival.alive:
            self._replace(rival, child)

    def cut_if_barren(self, node: Node) -> bool:
        """Cut a node all of whose children were cancelled, and so on upwards; return whether it was one."""
        if any(node.children):
            return False
        barren: Node | None = node
        while barren is not None and barren.parent is not None and not any(barren.children):
            above = barren.parent
            detach(barren)
            barren = above
        return True

    def _state(self, child: Node) -> State:
        level = child.level - 1
        held = self._path.held(level, send=child.send) if self._exact else ()
        return child.level, self._path.kept(level, send=child.send), held

    def _replace(self, old: Node, new: Node) -> None:
        above = old.parent
        new.visits, new.sum, new.expanded = old.visits, old.sum, old.expanded
        detach(old)
        new.children, old.children = old.children, [None, None]
        for child in new.living_children():
            child.parent = new
        if above is not None:
            self.cut_if_barren(above)
        self._settle(new, new.utility - old.utility)
        for ancestor in ancestors(new.parent):
            ancestor.visits += new.visits
            ancestor.sum += new.sum

    def _settle(self, new: Node, shift: float) -> None:
        """Give what moved below `new` its utilities and scores there, children before parents."""
        above, new.parent = new.parent, None
        if not self._exact:
            self._cut_what_breaks(new)
        moved: dict[int, float] = {}
        for node in reversed(subtree(new)):
            if node is not new:
                if node.expanded and not any(node.children):
                    detach(node)
                    continue
                node.utility += shift
            own = node.visits
            moved[node.index] = 0.0
            for child in node.living_children():
                own -= child.visits
                moved[node.index] += moved[child.index]
            moved[node.index] += own * shift / self._scale[node.level]
            node.sum += moved[node.index]
        new.parent = above
        new.expanded = any(child is not None for child in new.children)

    def _cut_what_breaks(self, new: Node) -> None:
        """Cut below `new` what breaks a constraint in its new place."""
        self._path.count(new.level - 1, send=new.send)
        for node in subtree(new)[1:]:
            if not node.alive:
                continue
            if node.send and not self._path.fits(node.level - 1):
                for lost in reversed(subtree(node)):
                    lost.alive = False
                detach(node)
                continue
            self._path.count(node.level - 1, send=node.send)
