"""Best mode with true dominance: a node gives way to one that is at least as good in all respects.

Best mode compares nodes that hold the same sends in the constraint windows. Here a node is dominated by another of its
level with the same states of the streams, at least the value, and no more use in any window that is still to be
checked: whatever may be sent below the one may be sent below the other.
"""

from collections.abc import Hashable

from planner.python_engine.best import Node
from planner.tables import Tables
from studies.designs.ablations import Best

Standing = tuple[Node, tuple[float, ...]]
"""A node and what it uses of each window that is still to be checked."""


class TrueDominance(Best):
    """Best mode whose nodes need not be equal to be compared."""

    def __init__(self, tables: Tables) -> None:
        super().__init__(tables)
        self._windows = open_windows(tables)
        self._standing: dict[tuple[int, tuple[Hashable, ...]], list[Standing]] = {}

    def _step(self, parent: Node, *, send: bool, bound: float) -> Node | None:
        level = parent.level
        value = parent.value + self._path.gain(level) if send else parent.value
        state = (level, self._path.states(level, send=send))
        uses = self._uses(level, send=send)
        rivals = [rival for rival in self._standing.get(state, []) if _attached(rival[0])]
        if any(rival.value >= value and _within(used, uses) for rival, used in rivals):
            self._standing[state] = rivals
            return None
        for rival, used in rivals:
            if value >= rival.value and _within(uses, used):
                self._remove(rival)
        self._path.step(level, send=send)
        child = self._create(parent, send=send, value=value, bound=bound)
        self._standing[state] = [*(rival for rival in rivals if rival[0].alive), (child, uses)]
        return child

    def _uses(self, level: int, *, send: bool) -> tuple[float, ...]:
        """Return what the windows open after this level hold once it is decided."""
        used, more = self._path.used, self._tables.checks.use[level].tolist() if send else None
        return tuple(
            used[level][of] - used[first][of] + (more[of] if more else 0.0) for of, first in self._windows[level]
        )


def open_windows(tables: Tables) -> list[list[tuple[int, int]]]:
    """Return for each level the windows open after it, as constraint and first level.

    These are the windows of checks of later levels that hold this level or earlier ones.
    """
    checks = tables.checks
    windows: list[list[tuple[int, int]]] = []
    for level in range(tables.levels):
        later = slice(int(checks.start[level + 1]), None)
        pairs = set(zip(checks.of[later].tolist(), checks.first[later].tolist(), strict=True))
        windows.append(sorted(pair for pair in pairs if pair[1] <= level))
    return windows


def _within(uses: tuple[float, ...], others: tuple[float, ...]) -> bool:
    """Whether no use exceeds that of the other."""
    return all(use <= other for use, other in zip(uses, others, strict=True))


def _attached(node: Node | None) -> bool:
    """Whether a node hangs in the tree: a removed one takes all below along, and their promises."""
    while node is not None:
        if not node.alive:
            return False
        node = node.parent
    return True
