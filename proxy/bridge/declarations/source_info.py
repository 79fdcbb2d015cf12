"""Gives replies source info, for which Zenoh's interface has no way.

Advanced subscribers tell by it what they have: who published a sample, and its number there. A mirror session that
answers puts it in front of the attachment, behind a mark that nobody else knows. On the link to the main session it
goes to where the protocol has it, so all the network sees is a reply with source info and the attachment it had.
"""

import secrets
from itertools import pairwise

import zenoh

from proxy.bridge.declarations.cursor import MORE, Cursor, WireError

_MARK = 16
_SIZE = 4
_FRONT = _MARK + _SIZE + 1
"""The mark, the size of the whole attachment, the size of the source info."""
_SOURCE = 0x41
"""Header of the extension for source info, of puts and deletes alike."""
_FRAGMENT, _FIRST = 0x06, 0x2
"""Kind of a message that holds a part of another; its extension that says that this is the first part."""
_ATTACHMENTS = (0x43, 0x42)
"""Those for the attachment of a put and of a delete."""


def new_mark() -> bytes:
    """Return a mark."""
    return secrets.token_bytes(_MARK)


def enclosed(mark: bytes, info: zenoh.SourceInfo, attachment: bytes | None) -> bytes:
    """Return an attachment that becomes `info` and `attachment` on the way."""
    source = encoded(info)
    rest = b"\x00" if attachment is None else b"\x01" + attachment
    size = _FRONT + len(source) + len(rest)
    return mark + size.to_bytes(_SIZE, "big") + bytes([len(source)]) + source + rest


def encoded(info: zenoh.SourceInfo) -> bytes:
    """Return source info as it is on the wire: id of a session, number of a publisher there, number of a sample."""
    number = int(str(info.source_id.zid), 16)
    zid = number.to_bytes(max(1, (number.bit_length() + 7) // 8), "little")
    return bytes([len(zid) - 1 << 4]) + zid + varint(info.source_id.eid) + varint(info.source_sn)


def varint(value: int) -> bytes:
    """Return an integer as it is on the wire: LEB128. Enough for 32 bits."""
    found = bytearray()
    while value >= MORE:
        found.append(value & 0x7F | MORE)
        value >>= 7
    return bytes((*found, value))


class SourceInfoInsertion:
    """What goes from the mirror session to its main session, with what `enclosed` made unfolded; all else is copied.

    Nothing has to be parsed for that: the mark tells where the extension with the attachment stands. It becomes one
    with the source info and one with what is left of the attachment, together shorter than it was: so each message
    stays in the batch or in the fragments that it has.
    """

    def __init__(self, mark: bytes) -> None:
        self._mark = mark
        self._rest = b""

    def feed(self, data: bytes) -> bytes:
        """Return what is to be passed on now that `data` came: whole batches."""
        data = self._rest + data
        ends = [0]
        while (start := ends[-1] + 2) <= len(data):
            end = start + int.from_bytes(data[start - 2 : start], "little")
            if end > len(data):
                break
            ends.append(end)
        whole, self._rest = data[: ends[-1]], data[ends[-1] :]
        if self._mark not in whole:
            return whole
        batches = (self._unfolded(whole[i + 2 : j]) for i, j in pairwise(ends))
        return b"".join(len(batch).to_bytes(2, "little") + batch for batch in batches)

    def _unfolded(self, batch: bytes) -> bytes:
        if _goes_on(batch):
            return batch
        done, at = [], 0
        while (found := batch.find(self._mark, at)) >= 0:
            place = self._place(batch, found)
            if place is None:
                end = found + _MARK
                done.append(batch[at:end])
            else:
                start, end, extensions = place
                done.append(batch[at:start] + extensions)
            at = end
        return b"".join((*done, batch[at:]))

    def _place(self, batch: bytes, found: int) -> tuple[int, int, bytes] | None:
        """Return where the extension begins, where in it the attachment does, and what takes the place between."""
        size = int.from_bytes(batch[found + _MARK : found + _FRONT - 1], "big")
        start = found - len(varint(size)) - 1
        end = found + _FRONT + int.from_bytes(batch[found + _FRONT - 1 : found + _FRONT]) + 1
        if start < 0 or end > len(batch) or batch[start + 1 : found] != varint(size):
            return None
        header, source, left = batch[start], batch[found + _FRONT : end - 1], size - (end - found)
        if header & ~MORE not in _ATTACHMENTS:
            return None
        if batch[end - 1]:
            return start, end, bytes([_SOURCE | MORE, len(source)]) + source + bytes([header]) + varint(left)
        return start, end, bytes([_SOURCE | header & MORE, len(source)]) + source


def _goes_on(batch: bytes) -> bool:
    """Whether it begins inside of a message.

    A mark there stands at the end of one fragment and the beginning of the next as well, with a little less before it.
    """
    data = Cursor(batch)
    try:
        header = data.byte()
        if header & 0x1F != _FRAGMENT:
            return False
        data.number()
        return _FIRST not in data.extensions(header)
    except WireError:
        return True
