"""Which keys copies wait for that a robot missed, on the wire."""

from proxy.core.protocol import checked, envelope
from proxy.core.protocol.tuning import TUNING


def pack_backlog(number: int, keys: tuple[str, ...] | None) -> bytes:
    """Return the message of that number on which keys copies wait; None: of too many to name."""
    return envelope.packed([number, keys])


def unpack_backlog(data: bytes) -> tuple[int, frozenset[str] | None]:
    """Return what `pack_backlog` was given; raise `MalformedWireError` when it is none."""
    number, keys = envelope.fields_of(data, TUNING.backlog_bytes, 3)[1:3]
    return checked.count(number), None if keys is None else frozenset(map(checked.key, checked.array(keys)))
