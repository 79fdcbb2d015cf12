"""Names of functions, read from memory: what the sampler saw may be gone, and must not be touched then."""

import struct
import sys
from dataclasses import dataclass
from types import CodeType

from proxy.profiling._native import words

_LARGE, _LONGEST = 40, 512
"""In how many words of a code object its names are looked for, and how long these may be [B]."""
_HEADER = sys.getsizeof("") - 1
"""What stands before the letters of a string [B]; its length is the third word."""
_TYPE, _LENGTH = 1, 2
"""Words of an object, of a string."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function, by the file in which it is and its name there."""

    file: str
    name: str


class Functions:
    """Names code objects by their addresses."""

    def __init__(self) -> None:
        known = Functions.of.__code__
        read = words(id(known), _LARGE)
        self._file, self._name = read.index(id(known.co_filename)), read.index(id(known.co_qualname))
        self._known: dict[int, Function | None] = {}

    def of(self, address: int) -> Function | None:
        """Return the function whose code is there; None where none is."""
        if address not in self._known:
            self._known[address] = self._read(address)
        return self._known[address]

    def _read(self, address: int) -> Function | None:
        read = words(address, _LARGE)
        if not read or read[_TYPE] != id(CodeType):
            return None
        file, name = _text(read[self._file]), _text(read[self._name])
        return Function(file, name) if file and name else None


def _text(address: int) -> str:
    """Return the string that is there; empty where none is, or one of other letters than ours."""
    head = words(address, 3)
    if not head or head[_TYPE] != id(str) or not 0 < head[_LENGTH] <= _LONGEST:
        return ""
    size = _HEADER + head[_LENGTH]
    read = words(address, -(-size // 8))
    raw = struct.pack(f"{len(read)}Q", *read)[_HEADER:size]
    return raw.decode("ascii", errors="replace")
