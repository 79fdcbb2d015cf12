"""Reads the pieces that messages of Zenoh's wire protocol are made of.

Integers are LEB128, extensions carry their own size.
"""

MORE, SUFFIX, SENDERS = 0x80, 0x20, 0x40
"""Flags of a header: extensions follow; a suffix follows the scope; the scope is a number of the sender's."""


class WireError(ValueError):
    """Bytes that are not what this reader knows of the protocol."""


class Cursor:
    """Reads bytes one after the other; `at` is where it stands."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self.at = 0

    def __bool__(self) -> bool:
        return self.at < len(self._data)

    def byte(self) -> int:
        """Return the next byte."""
        if self.at >= len(self._data):
            raise WireError("a message ends early")
        self.at += 1
        return self._data[self.at - 1]

    def step_back(self) -> None:
        """Read the last byte again."""
        self.at -= 1

    def take(self, size: int) -> bytes:
        """Return the next `size` bytes."""
        if self.at + size > len(self._data):
            raise WireError("a message ends early")
        self.at += size
        return self._data[self.at - size : self.at]

    def rest(self) -> bytes:
        """Return all that is left."""
        return self.take(len(self._data) - self.at)

    def number(self) -> int:
        """Return an integer."""
        value = 0
        for shift in range(0, 63, 7):
            byte = self.byte()
            if shift == 56:  # the ninth byte holds eight bits
                return value | byte << shift
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
        raise WireError("unreachable")

    def sized(self) -> bytes:
        """Return bytes that carry their size."""
        return self.take(self.number())

    def text(self) -> str:
        """Return text that carries its size."""
        return self.sized().decode()

    def extensions(self, header: int) -> dict[int, int | bytes]:
        """Return what follows a header with the Z flag, by id."""
        found: dict[int, int | bytes] = {}
        while header & MORE:
            header = self.byte()
            found[header & 0x0F] = self._extension(header)
        return found

    def _extension(self, header: int) -> int | bytes:
        encoding = header & 0x60
        if encoding == 0x60:
            raise WireError("an extension of unknown encoding")
        return self.sized() if encoding == 0x40 else self.number() if encoding == 0x20 else 0

    def expression(self, header: int) -> tuple[int, str, bool]:
        """Return a key expression: scope, suffix, and whether the scope is the sender's number."""
        scope = self.number()
        return scope, self.text() if header & SUFFIX else "", bool(header & SENDERS)
