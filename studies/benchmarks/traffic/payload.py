"""What the payload of each published sample begins with: enough to recognise it wherever it passes."""

import struct
from dataclasses import dataclass

MARK = bytes.fromhex("9d53e1b7f00d77a6")
"""Found nowhere else on the wire, for the payloads that follow are zeros."""
_HEAD = struct.Struct("<8sBBIId")
HEAD = _HEAD.size
"""Bytes of it: no payload is smaller [B]."""


@dataclass(frozen=True, slots=True)
class Label:
    """The number of a robot's sample in one of its streams, its `size` [B], when it was published [s, monotonic]."""

    robot: int
    stream: int
    number: int
    size: int
    t_gen: float

    @property
    def name(self) -> tuple[int, int, int]:
        """Which sample of all it is."""
        return self.robot, self.stream, self.number


def payload(label: Label) -> bytes:
    """Return the payload of a sample. Raises ValueError where the label does not fit in."""
    if label.size < HEAD:
        raise ValueError(f"a sample of {label.size} B has no room for its label of {HEAD} B")
    head = _HEAD.pack(MARK, label.robot, label.stream, label.number, label.size, label.t_gen)
    return head + bytes(label.size - HEAD)


def read(data: bytes, at: int = 0) -> Label:
    """Return the label that begins at a place of `data`. Raises struct.error where it is cut short."""
    return Label(*_HEAD.unpack_from(data, at)[1:])
