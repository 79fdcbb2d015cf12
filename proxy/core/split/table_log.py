"""The tables of one robot as a log: the first entry is the last table agreed on, the last one is the newest."""

from collections.abc import Container, Iterator, Mapping

from proxy.core.protocol.bid import UNIT
from proxy.core.split.table import Table
from proxy.core.split.tuning import TUNING


class TableLog:
    """What a robot may use is the least that any entry gives it which counts."""

    def __init__(self, now: float, first: Table) -> None:
        self._tables = [first]
        self._compacted = UNIT
        """The least part that entries gave which are no longer kept one by one [units]."""
        self._formed_at = now
        """When the newest table was formed [s]."""
        self.agreed_at, self.took = now, 0.0
        """When the first entry was agreed on, and how long that took [s]."""

    def __iter__(self) -> Iterator[Table]:
        """From the one agreed on to the newest one."""
        return iter(self._tables)

    @property
    def agreed(self) -> Table:
        """The last table that was agreed on, if any was."""
        return self._tables[0]

    @property
    def newest(self) -> Table:
        """The newest table."""
        return self._tables[-1]

    @property
    def pending(self) -> bool:
        """Whether there are tables after the one agreed on."""
        return len(self._tables) > 1

    @property
    def part(self) -> int:
        """The least that tables which count give us without slots [units]."""
        return min([self._compacted, *(table.part for table in self._tables if table.counts)])

    @property
    def total(self) -> int:
        """The least that they give us now, slots that we hold included [units]."""
        return min([self._compacted, *(table.total for table in self._tables if table.counts)])

    def append(self, now: float, table: Table) -> None:
        """Our newest table is this one, if it is another one."""
        if table.name != self.newest.name:
            self._tables.append(table)
            self._formed_at = now

    def reserve(self, table: Table) -> None:
        """Robots came: until all agree on a table with them, what this one leaves them is theirs."""
        self._tables.append(table)

    def announced(self, now: float, name: int) -> None:
        """A digest of ours names this as the table that we have: from now on others may agree on it."""
        for table in self._tables:
            if table.name == name:
                table.announced(now)

    def confirm(self, names: Mapping[str, Container[int]]) -> None:
        """By tag, these are the names of tables that robots have."""
        for table in self._tables:
            table.confirm(names)

    def agree(self, now: float, index: int) -> None:
        """This entry is agreed on: leave out all before it."""
        self._tables = self._tables[index:]
        self.agreed.begin(now)
        self._compacted, self.agreed_at, self.took = UNIT, now, now - self._formed_at

    def compact(self) -> None:
        """Keep the least part alone of tables between the first and the newest ones, where they are many."""
        while len(self._tables) > TUNING.tables_kept:
            table = self._tables.pop(1)
            self._compacted = min(self._compacted, table.part) if table.counts else self._compacted
