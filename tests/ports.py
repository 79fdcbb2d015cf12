"""Free ports, so that tests that run side by side do not meet."""

import random
import socket

_PORTS = range(12_000, 32_000)
"""Below those that the kernel gives to outgoing connections: they could take a port before its listener does."""


def free_port() -> int:
    """Return a port of the loopback interface that nobody listens on now."""
    # Not one after the other: processes that test side by side would look for the same.
    for port in random.sample(_PORTS, 100):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
    raise OSError("no free port found")
