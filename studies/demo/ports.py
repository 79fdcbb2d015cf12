"""Free ports of localhost, so that runs side by side do not meet."""

import atexit
import os
import socket
from collections.abc import Iterator
from functools import cache
from itertools import cycle, islice

_FIRST, _LAST = 10_000, 32_000
"""Below those that the kernel gives to outgoing connections: they could take a port before its listener does."""
_EACH = 500
"""Ports that one process has for itself."""


def is_free(port: int) -> bool:
    """Whether nobody listens at a port of localhost now."""
    with socket.socket() as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
        return True


def free_ports(count: int) -> list[int]:
    """Return ports of localhost that nobody listens at now, and that no other run is given for a while.

    Raises OSError when there are not so many.
    """
    found = list(islice(filter(is_free, islice(_own(os.getpid()), _EACH)), count))
    if len(found) < count:
        raise OSError("not enough free ports found")
    return found


@cache
def _own(_process: int) -> Iterator[int]:
    """Claim ports that no other process that asks has, as long as this one lives; return them again and again.

    A process that forks shares what it had found with its child, so each asks for itself.
    """
    for first in range(_FIRST, _LAST, _EACH):
        sign = socket.socket(socket.AF_UNIX)
        try:
            sign.bind(f"\0sendworthy-ports-{first}")
        except OSError:
            sign.close()
            continue
        atexit.register(sign.close)
        return cycle(range(first, first + _EACH))
    raise OSError("too many processes ask for ports at once")
