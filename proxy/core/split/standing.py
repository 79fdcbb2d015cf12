"""Tables that count for our part: what all bid, by what we know, and who had the same table."""

import hashlib
from collections.abc import Mapping

from proxy.core.protocol.bid import Bid, packed
from proxy.core.split.allocation import RULES, Allocation, allocate
from proxy.core.split.turns import Turn

Entry = tuple[int, Bid]
"""A version and the bid in it."""


class Standing:
    """A table, what it gives us, and which robots told that they had it.

    Its name is a hash, which stands for the table itself: two tables of one name are the same one.
    """

    def __init__(self, own: str, table: Mapping[str, Entry | None], *, members: int, floor: int, kind: bytes) -> None:
        self.own, self.table = own, dict(table)
        self.name = _name(self.table, members, kind)
        bids = {tag: entry and entry[1] for tag, entry in self.table.items()}
        self.allocation: Allocation = allocate(bids, members, floor, self.name)
        self.turns = [Turn(slot) for slot in self.allocation.slots]
        self.bidders = {tag for tag, entry in self.table.items() if entry is not None} - {own}
        """Whose bids it holds, without us. One whose bid is not known cannot have this table, and needs not."""
        self.told: set[str] = set()
        """Who told that it had it."""
        self.counts = False
        """Whether what it gives us is the most that we may use: we agreed on it, or others may have."""

    @property
    def agreed(self) -> bool:
        """Whether all whose bids it holds had it."""
        return self.bidders <= self.told

    @property
    def complete(self) -> bool:
        """Whether it holds everybody's bid."""
        return None not in self.table.values()

    @property
    def part(self) -> int:
        """What it gives us alone [units]."""
        return self.allocation.parts[self.own]

    @property
    def total(self) -> int:
        """What it gives us now [units]: our part, and the slots that we hold."""
        return self.part + sum(turn.slot.size for turn in self.turns if turn.holder == self.own)


def _name(table: Mapping[str, Entry | None], members: int, kind: bytes) -> int:
    """Return four bytes that stand for a table; never 0, which stands for none."""
    digest = hashlib.blake2b(b"%d " % RULES + kind + members.to_bytes(4, "big"), digest_size=4)
    for tag, entry in sorted(table.items()):
        version, bid = entry or (-1, ())
        told = packed(bid)
        digest.update(b"%d %d %d " % (len(tag.encode()), version, len(told)) + tag.encode() + told)
    return int.from_bytes(digest.digest(), "big") or 1
