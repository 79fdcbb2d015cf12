"""A link over which nothing leaves any more, as the kernel sees it."""

from pathlib import Path

from proxy.bridge.send_buffers import _NOT_SENT, _UNACKED, _buffer
from proxy.bridge.sockets import tcp_info
from tests.waiting import wait_until


def wait_for_jam():
    """Wait until a TCP socket of this process is full and the other end has no room: what is in it stays there."""
    wait_until(lambda: any(_jammed(int(file.name)) for file in Path("/proc/self/fd").iterdir()), what="the jam")


def _jammed(number):
    """Whether all that was sent has arrived, the rest finds no room there, and no more of it finds room here."""
    info = tcp_info(number)
    if info is None:
        return False
    (unacked,), (not_sent,), (size, held) = _UNACKED.unpack_from(info), _NOT_SENT.unpack_from(info), _buffer(number)
    return unacked == 0 and not_sent > 0 and held >= size
