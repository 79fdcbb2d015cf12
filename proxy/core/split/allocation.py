"""Parts of a limit out of everybody's bids: a pure function that all robots compute alike."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from operator import itemgetter

from proxy.core.protocol.bid import QUARTERS, UNIT, Bid, Segment, density_of
from proxy.core.split.tuning import TUNING

RULES = 7
"""Counts how parts are made of bids: robots that do it another way never agree with us."""

Bids = Mapping[str, Bid | None]
"""What each robot asks for, by tag; None: not known yet."""


@dataclass(frozen=True, slots=True)
class Slot:
    """Room for one message in every window, for several robots in turn."""

    size: int
    """[units]"""
    ring: tuple[tuple[str, int], ...]
    """Who comes after whom, and for how many windows in relation to the others."""


@dataclass(frozen=True, slots=True)
class Allocation:
    """What each robot has for itself [units], and slots that they share."""

    parts: Mapping[str, int]
    slots: tuple[Slot, ...]

    @property
    def total(self) -> int:
        """All of it together [units]."""
        return sum(self.parts.values()) + sum(slot.size for slot in self.slots)

    @property
    def alike(self) -> float:
        """Of how many robots equal parts would vary together by as much as these do, if each varies by itself."""
        return self.total**2 / max(1, sum(part * part for part in self.parts.values()))

    def carries(self, tag: str, amount: int) -> bool:
        """Whether a message that takes so much of a limit fits what a robot has [units]."""
        return self.largest(tag) >= _needed(amount)

    def worth(self, bids: Mapping[str, Bid], *, divisible: bool = False) -> float:
        """Return what slots are worth to all together [utility/s]: the same to the last bit, however bids are ordered.

        And what `divisible` room is worth to them, if that is to count.
        """
        worth = (_worth(bid, self.mean(tag), self.largest(tag), divisible=divisible) for tag, bid in bids.items())
        return math.fsum(worth)

    def largest(self, tag: str) -> int:
        """Return the largest message that a robot may send at some time [units]."""
        slots = (slot.size for slot in self.slots if any(tag == each for each, _ in slot.ring))
        return max(self.parts.get(tag, 0), *slots, 0)

    def mean(self, tag: str) -> float:
        """Return what a robot has in the mean [units]."""
        shared = (slot.size * dict(slot.ring).get(tag, 0) / sum(turn for _, turn in slot.ring) for slot in self.slots)
        return self.parts.get(tag, 0) + sum(shared)

    def resembles(self, other: "Allocation") -> bool:
        """Whether the same robots share the same slots, and all amounts are about the same."""
        if [sorted(slot.ring) for slot in self.slots] != [sorted(slot.ring) for slot in other.slots]:
            return False
        sizes = [(one.size, two.size) for one, two in zip(self.slots, other.slots, strict=True)]
        amounts = [*sizes, *((part, other.parts.get(tag, -UNIT)) for tag, part in self.parts.items())]
        return all(abs(one - two) <= TUNING.alike_part * max(one, two) + TUNING.alike_units for one, two in amounts)


def worth_of_equal(bids: Mapping[str, Bid]) -> float:
    """Return what slots would be worth to all together that each had an equal part of, as `Allocation.worth` does."""
    return math.fsum(_worth(bid, UNIT / len(bids), UNIT) for bid in bids.values())


def _worth(bid: Bid, room: float, largest: float, *, divisible: bool = False) -> float:
    """Return what slots are worth to a robot with so much room in the mean, but no messages beyond the `largest`.

    What it asks for is larger than most messages, so nearly as much does.
    """
    total = 0.0
    for segment in bid:
        if segment.quarters and (1.0 - TUNING.alike_part) * _needed(segment.amount) > largest:
            continue
        served = min(segment.asked, room)
        room -= served
        if segment.quarters or divisible:
            total += served * density_of(segment.level)
    return total


def _needed(amount: int) -> int:
    """Return the room that a message needs which takes so much [units]."""
    return TUNING.whole_slot if amount == UNIT else amount


def allocate(table: Bids, members: int, floor: int, seed: int = 0) -> Allocation:
    """Return what each robot of the `table` may use.

    Units go to segments by falling value density (water-filling), evenly where it is equal. A message is served whole:
    it gets pieces of a slot. What nobody asks for goes to all alike. `members` counts those of whom an unknown one gets
    an equal part, `floor` [units] is given to nobody, `seed` says who of a ring comes first. All numbers are whole, and
    ties break by tag, so all machines agree.
    """
    return _allocate(tuple(sorted(table.items())), members, floor, seed)


@lru_cache(maxsize=32)
def _allocate(table: tuple[tuple[str, Bid | None], ...], members: int, floor: int, seed: int) -> Allocation:
    filling = _Filling(table, members, floor)
    segments = [(tag, segment) for tag, bid in table for segment in bid or ()]
    # By falling level; divisible ones first, as they fit in any case.
    segments.sort(key=lambda entry: (-entry[1].level, entry[1].quarters, entry[0]))
    for _, alike in groupby(segments, key=lambda entry: entry[1].level):
        filling.serve(list(alike))
    urgency = {tag: max((s.level for s in bid or () if s.quarters), default=0) for tag, bid in table}
    return filling.allocation(urgency, seed)


class _OpenSlot:
    """A slot that is being filled: pieces by robot."""

    def __init__(self, size: int) -> None:
        self.size, self.pieces, self.whole = size, Counter[str](), False
        self.left = TUNING.slot_pieces

    def take(self, tag: str, amount: int) -> None:
        self.whole |= amount == UNIT
        self.pieces[tag] += 1
        self.left -= 1

    def grow(self, amount: int) -> None:
        self.size += amount


class _Filling:
    """What is left, and who has what so far."""

    def __init__(self, table: tuple[tuple[str, Bid | None], ...], members: int, floor: int) -> None:
        equal = (UNIT - floor) // max(1, members)
        self._parts = {tag: equal if bid is None else 0 for tag, bid in table}
        self._known = [tag for tag, bid in table if bid is not None]
        self._left = max(0, UNIT - floor - sum(self._parts.values()))
        self._slots: list[_OpenSlot] = []
        least = min(equal, self._left // max(1, len(self._known))) // TUNING.assured_part
        self._assured = {tag: min(least, sum(s.amount for s in bid or () if not s.quarters)) for tag, bid in table}
        """What of it was given before values counted and is not served yet."""
        for tag, amount in self._assured.items():
            self._give(tag, amount)

    def _give(self, tag: str, amount: int) -> None:
        self._parts[tag] += amount
        self._left -= amount

    def serve(self, segments: list[tuple[str, Segment]]) -> None:
        """Serve segments of one level: divisible ones evenly, then messages."""
        wanted = Counter[str]()
        for tag, segment in segments:
            if not segment.quarters:
                had = min(segment.amount, self._assured[tag])
                self._assured[tag] -= had
                wanted[tag] += segment.amount - had
        # The smallest first, each at most an even part of what is left.
        for place, tag in enumerate(sorted(wanted, key=lambda tag: (wanted[tag], tag))):
            self._give(tag, min(wanted[tag], self._left // (len(wanted) - place)))
        self._serve_messages([(tag, segment) for tag, segment in segments if segment.quarters])

    def _serve_messages(self, messages: list[tuple[str, Segment]]) -> None:
        """Serve messages of one level: who asks for a whole slot has one, then the others a piece each and again."""
        asked = Counter[str]()
        for tag, segment in messages:
            asked[tag] += segment.quarters
        # Nothing is gained by turns where the last message is worth as much as the first: each has one, then some two.
        whole, before = list[tuple[int, str, Segment]](), Counter[str]()
        for tag, segment in messages:
            if asked[tag] >= QUARTERS:
                whole.append((before[tag] // QUARTERS, tag, segment))
                before[tag] += segment.quarters
        for _, tag, segment in sorted(whole, key=itemgetter(0, 1)):
            for _ in range(segment.quarters * TUNING.slot_pieces // QUARTERS):
                self._place(tag, segment.amount)
        for piece in range(TUNING.slot_pieces):
            for tag, segment in messages:
                if asked[tag] < QUARTERS and segment.quarters * TUNING.slot_pieces > piece * QUARTERS:
                    self._place(tag, segment.amount)

    def _place(self, tag: str, amount: int) -> None:
        """Give a robot a piece of a slot for a message of this size, if there is one."""
        size = _needed(amount)
        slot = self._own(tag, size) or self._new(size) or self._shared(size)
        if slot is not None:
            slot.take(tag, amount)

    def _own(self, tag: str, size: int) -> _OpenSlot | None:
        return next((slot for slot in self._slots if slot.left and tag in slot.pieces and slot.size >= size), None)

    def _new(self, size: int) -> _OpenSlot | None:
        if size > self._left:
            return None
        self._left -= size
        self._slots.append(_OpenSlot(size))
        return self._slots[-1]

    def _shared(self, size: int) -> _OpenSlot | None:
        """Return the slot that must grow least; of these, that with most pieces left."""
        slots = [slot for slot in self._slots if slot.left and size - slot.size <= self._left]
        if not slots:
            return None
        slot = min(slots, key=lambda slot: (max(0, size - slot.size), -slot.left))
        more = max(0, size - slot.size)
        self._left -= more
        slot.grow(more)
        return slot

    def allocation(self, urgency: Mapping[str, int], seed: int) -> Allocation:
        """Return what each has; what is left goes to all who bid, alike."""
        for slot in [slot for slot in self._slots if slot.whole][:1]:
            slot.grow(self._left)
            self._left = 0
        for slot in self._slots:
            if len(slot.pieces) == 1:
                self._parts[next(iter(slot.pieces))] += slot.size
        for tag in self._known:
            self._parts[tag] += self._left // len(self._known)
        shared = (slot for slot in self._slots if len(slot.pieces) > 1)
        return Allocation(self._parts, tuple(Slot(slot.size, _ring(slot.pieces, urgency, seed)) for slot in shared))


def _ring(pieces: Mapping[str, int], urgency: Mapping[str, int], seed: int) -> tuple[tuple[str, int], ...]:
    """Return who comes after whom, the far more urgent first, and how long each turn is in relation to the shortest."""
    least, tags = min(pieces.values()), sorted(pieces)
    first = seed % len(tags)
    order = sorted(tags[first:] + tags[:first], key=lambda tag: -(urgency[tag] // TUNING.urgency_levels))
    return tuple((tag, min(TUNING.turn_ratio, (2 * pieces[tag] + least) // (2 * least))) for tag in order)
