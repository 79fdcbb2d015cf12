"""Free ports, so that tests that run side by side do not meet."""

import atexit
import itertools
import socket

_FIRST, _LAST = 12_000, 32_000
"""Below those that the kernel gives to outgoing connections: they could take a port before its listener does."""
_EACH = 500
"""Ports that one process has for itself."""


def _own() -> range:
    """Return ports that no other process of tests has, as long as this one lives."""
    for first in range(_FIRST, _LAST, _EACH):
        sign = socket.socket(socket.AF_UNIX)
        try:
            sign.bind(f"\0sendworthy-tests-{first}")
        except OSError:
            sign.close()
            continue
        atexit.register(sign.close)
        return range(first, first + _EACH)
    raise OSError("too many processes test at once")


_ports = itertools.cycle(_own())


def free_port() -> int:
    """Return a port of the loopback interface that nobody listens on now, and nobody gets for a while."""
    for port in itertools.islice(_ports, _EACH):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
    raise OSError("no free port found")
