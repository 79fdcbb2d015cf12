"""The native engine behind the planner's interface: C++ searches that run without the GIL."""

from typing import TYPE_CHECKING

from planner import _native
from planner.answers import Found, answer
from planner.native_tables import NativeTables
from planner.search import Plan, SearchSettings
from planner.tables import Tables

if TYPE_CHECKING:
    from planner.python_engine import best, tree


class NativeSearch:
    """A search of the native engine. Use one search from one thread at a time."""

    def __init__(self, tables: Tables, settings: SearchSettings) -> None:
        self._tables = tables
        source = tables.tabulated if isinstance(tables, NativeTables) else tables
        self._kernel: _native.PaperSearch | _native.BestSearch
        if settings.search == "paper":
            self._kernel = _native.PaperSearch(source, settings.exploration, settings.reduction, settings.max_nodes)
        else:
            self._kernel = _native.BestSearch(source, settings.max_nodes)

    @property
    def iterations(self) -> int:
        """Iterations done so far."""
        return self._kernel.iterations

    @property
    def done(self) -> bool:
        """Whether no remaining iteration can change the decision."""
        return self._kernel.done

    def run(self, iterations: int) -> int:
        """Run at most `iterations` more; return how many ran (fewer when done)."""
        return self._kernel.run(iterations)

    def plan(self) -> Plan:
        """Return the best answer so far; defined after any number of iterations, zero included."""
        sends, opposite, bound, asked, nodes = self._kernel.plan()
        return answer(self._tables, Found(sends, opposite, bound, asked, nodes), self.iterations)

    def tree(self) -> "list[tree.Row] | list[best.Row]":
        """Every node in the order of creation, to compare engines."""
        return self._kernel.tree()
