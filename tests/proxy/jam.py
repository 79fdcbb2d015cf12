"""A link over which nothing leaves any more, as the kernel sees it."""

import time
from pathlib import Path

from proxy.bridge.send_buffers import _ACKED, _buffer
from proxy.bridge.sockets import tcp_info
from tests.waiting import wait_until

STILL = 0.5
"""Nothing arrives for so long where a link stands still [s]: the other end has no room, or drops what comes."""


def wait_for_jam():
    """Wait until a TCP socket of this process is full, and nothing of that arrives at the other end."""
    arrived = {}

    def jammed():
        numbers = [int(file.name) for file in Path("/proc/self/fd").iterdir()]
        return True in [_stands_still(number, arrived) for number in numbers]

    wait_until(jammed, what="the jam")


def _stands_still(number, arrived):
    """Whether who writes waits for room; `arrived` holds how much arrived over each socket [B], and since when."""
    info = tcp_info(number)
    size, held = _buffer(number)
    if info is None or held / 2 <= size - held:  # there the kernel calls who waits for room
        return False
    now, (acked,) = time.monotonic(), _ACKED.unpack_from(info)
    before, since = arrived.get(number, (None, now))
    arrived[number] = acked, since if acked == before else now
    return acked == before and now >= since + STILL
