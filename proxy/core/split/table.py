"""A table: the bids of all robots that one robot knows, what they give it, and who has the same table."""

import hashlib
from collections.abc import Container, Iterator, Mapping

from proxy.core.protocol.bid import UNIT, Bid, packed
from proxy.core.split.allocation import RULES, Allocation, allocate
from proxy.core.split.tuning import TUNING
from proxy.core.split.turns import Turn

Entry = tuple[int, Bid]
"""A version and the bid in it."""


class Table:
    """The bids of all members, None where one is not known, named by a hash, and which robots confirmed the same."""

    def __init__(
        self,
        own: str,
        entries: Mapping[str, Entry | None],
        *,
        members: int,
        floor: int,
        kind: bytes,
        counts: bool = False,
    ) -> None:
        self.own, self.entries, self._floor = own, dict(entries), floor
        self.name = _name(self.entries, members, kind)
        bids = {tag: entry and entry[1] for tag, entry in self.entries.items()}
        self.allocation: Allocation = allocate(bids, members, floor, self.name)
        self.turns = [Turn(slot) for slot in self.allocation.slots]
        self.bidders = {tag for tag, entry in self.entries.items() if entry is not None} - {own}
        """Whose bids it holds, without us. One whose bid is not known cannot have this table, and needs not."""
        self.confirmed_by: set[str] = set()
        self.counts = counts
        """Whether what it gives us is the most that we may use: we agreed on it, or others may have."""

    @property
    def agreed(self) -> bool:
        """Whether all whose bids it holds have it."""
        return self.bidders <= self.confirmed_by

    @property
    def complete(self) -> bool:
        """Whether it holds everybody's bid."""
        return None not in self.entries.values()

    @property
    def part(self) -> int:
        """What it gives us alone [units]."""
        return self.allocation.parts[self.own]

    @property
    def total(self) -> int:
        """What it gives us now [units]: our part, and the slots that we hold."""
        return self.part + sum(turn.slot.size for turn in self.turns if turn.holder == self.own)

    def confirm(self, names: Mapping[str, Container[int]]) -> None:
        """By tag, these are the names of tables that robots have."""
        self.confirmed_by |= {tag for tag, held in names.items() if self.name in held}

    def announced(self) -> None:
        """Others hear that we have it, and may agree on it."""
        self.counts = True

    def begin(self, now: float) -> None:
        """It is agreed on: its turns begin."""
        self.counts = True
        for turn in self.turns:
            turn.begin(now)

    def allocated(self, bids: Mapping[str, Bid]) -> Allocation:
        """Return what each would have with these bids."""
        return allocate(bids, len(bids), self._floor, self.name)


def _name(entries: Mapping[str, Entry | None], members: int, kind: bytes) -> int:
    """Return four bytes that stand for a table; never 0, which stands for none."""
    digest = hashlib.blake2b(b"%d " % RULES + kind + members.to_bytes(4, "big"), digest_size=4)
    for tag, entry in sorted(entries.items()):
        version, bid = entry or (-1, ())
        data = packed(bid)
        digest.update(b"%d %d %d " % (len(tag.encode()), version, len(data)) + tag.encode() + data)
    return int.from_bytes(digest.digest(), "big") or 1


class TableLog:
    """The tables of one robot, from the last agreed on to the newest: it may use the least that any gives it."""

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

    def announced(self, name: int) -> None:
        """A digest of ours names this as the table that we have: from now on others may agree on it."""
        for table in self._tables:
            if table.name == name:
                table.announced()

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
