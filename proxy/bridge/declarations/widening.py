"""Lets a mirror session be told of everything.

A client is told what it declares an interest in. Zenoh's interface has it name a key expression, and none matches all
keys: `**` matches no chunk that begins with `@`, and what apps will ask for cannot be known before they do. The
protocol, though, knows an interest without a key expression: in everything. So the mirror session declares
interests in one key of ours, and on the way out they lose it.
"""

from contextlib import suppress

from proxy.bridge.declarations.cursor import SENDERS, SUFFIX, WireError
from proxy.bridge.declarations.wire import RESTRICTED, Batches, Interest, KeyNumber
from proxy.bridge.keys import PREFIX

EVERYTHING = f"{PREFIX}/everything"
"""An interest in this becomes one in everything."""


class InterestWidening:
    """What goes from the mirror session to its main session, with the first `interests` in `EVERYTHING` widened.

    After those it only copies, and so it does with what it does not understand; the table of the link says so.
    """

    def __init__(self, interests: int) -> None:
        self._left = interests
        self._number: int | None = None
        self._buffer = bytearray()

    @property
    def done(self) -> bool:
        """Whether all of them have passed."""
        return not self._left

    def feed(self, data: bytes) -> bytes:
        """Return what is to be passed on now that `data` came."""
        if not self._left and not self._buffer:
            return data
        self._buffer += data
        out = bytearray()
        while len(self._buffer) >= 2:
            size = int.from_bytes(self._buffer[:2], "little")
            if len(self._buffer) < size + 2:
                break
            batch = self._widened(bytes(self._buffer[2 : size + 2]))
            out += len(batch).to_bytes(2, "little") + batch
            del self._buffer[: size + 2]
        return bytes(out)

    def _widened(self, batch: bytes) -> bytes:
        found: list[Interest] = []
        if self._left:
            with suppress(WireError, UnicodeDecodeError):
                for message in Batches().read(batch):
                    if isinstance(message, KeyNumber) and message.suffix == EVERYTHING:
                        self._number = message.number
                    elif isinstance(message, Interest) and self._is_ours(message):
                        found.append(message)
        self._left -= len(found)
        for interest in reversed(found):
            options = batch[interest.options] & ~(RESTRICTED | SUFFIX | SENDERS)
            batch = batch[: interest.options] + bytes([options]) + batch[interest.end :]
        return batch

    def _is_ours(self, interest: Interest) -> bool:
        by_number = interest.scope == self._number and not interest.suffix
        return by_number or (not interest.scope and interest.suffix == EVERYTHING)
