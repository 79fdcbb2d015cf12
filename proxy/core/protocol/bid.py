"""Bids: what a robot asks for of a shared limit, and what each part of that is worth."""

import math
from dataclasses import dataclass

from proxy.core.protocol.tuning import TUNING

UNIT = 10_000
"""Parts of a limit are counted in units of 1/10,000: whole numbers, so that all machines agree."""
QUARTERS = 4
"""A slot is shared in time by quarters."""
STEPS = 8
"""Levels in which the value doubles: 9 % each. With 19 % slots went by names (93 % of a central decider, now 94)."""
MIDDLE = 192
"""The level of a value density of 1."""
TOP = 255
_SHARES = (0, 1, 2, 4)
"""Quarters that a segment may ask for; 0: it is divisible."""
_BYTES = 3


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of what a robot asks for: an `amount` in every window [units], or in `quarters` of them as one message."""

    amount: int
    level: int
    """Value density, on a logarithmic scale: `level_of` utility per second and unit."""
    quarters: int = 0

    def __post_init__(self) -> None:
        """Raise `ValueError` where it is none."""
        if not (0 < self.amount <= UNIT and 0 <= self.level <= TOP and self.quarters in _SHARES):
            raise ValueError(f"no segment of a bid: {self.amount}, {self.level}, {self.quarters}")

    @property
    def asked(self) -> int:
        """What it asks for in the mean [units]."""
        return self.amount * self.quarters // QUARTERS if self.quarters else self.amount


Bid = tuple[Segment, ...]
"""What a robot asks for; `allocate` serves it by falling level."""


def level_of(density: float) -> int:
    """Return the level of a value density [utility/s per unit]."""
    if density <= 0.0:
        return 0
    return max(0, min(TOP, MIDDLE + round(STEPS * math.log2(density))))


def density_of(level: int) -> float:
    """Return the value density of a level [utility/s per unit]."""
    return float(2.0 ** ((level - MIDDLE) / STEPS))


def packed(bid: Bid) -> bytes:
    """Return the wire form of a bid: three bytes a segment."""
    numbers = ((s.amount << 10) | (s.level << 2) | _SHARES.index(s.quarters) for s in bid)
    return b"".join(number.to_bytes(_BYTES, "big") for number in numbers)


def unpacked(data: bytes) -> Bid:
    """Return the bid in `data`; raise `ValueError` where it is none."""
    if len(data) % _BYTES or len(data) > _BYTES * TUNING.segments:
        raise ValueError(f"no bid has {len(data)} bytes")
    numbers = (int.from_bytes(data[at : at + _BYTES], "big") for at in range(0, len(data), _BYTES))
    return tuple(Segment(number >> 10, number >> 2 & TOP, _SHARES[number & 3]) for number in numbers)


def alike(one: Bid, other: Bid, part: float = 0.25) -> bool:
    """Whether two bids ask for about the same: the same kinds, levels but for one step, amounts but for a `part`."""
    if len(one) != len(other):
        return False
    return all(
        a.quarters == b.quarters and abs(a.level - b.level) <= 1 and abs(a.amount - b.amount) <= part * a.amount
        for a, b in zip(one, other, strict=True)
    )


def alike_but_for_slots(one: Bid, other: Bid) -> bool:
    """Whether a robot asks for slots in both, which are worth about as much to it, and all else is alike and little."""
    parts = [tuple(segment for segment in bid if not segment.quarters) for bid in (one, other)]
    before, after = ([segment for segment in bid if segment.quarters] for bid in (one, other))
    if not (before and after and few_parts(other) and alike(parts[0], parts[1])):
        return False
    low, high = sorted(sum(s.asked * density_of(s.level) for s in slots) for slots in (before, after))
    return high <= TUNING.slots_alike * low


def few_parts(bid: Bid) -> bool:
    """Whether a robot asks for little that is divisible: what more of that is worth to it is not known as well."""
    return sum(segment.amount for segment in bid if not segment.quarters) <= TUNING.few_parts
