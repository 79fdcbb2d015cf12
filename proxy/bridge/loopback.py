"""`localhost` is 127.0.0.1 and, where there is IPv6, also ::1. Where there is none, nobody can listen there."""

import logging
import socket
from collections.abc import Iterable

log = logging.getLogger(__name__)

IPV6 = "/[::1]:"


def has_ipv6() -> bool:
    """Whether this host has the address ::1."""
    try:
        with socket.socket(socket.AF_INET6) as probe:
            probe.bind(("::1", 0))
    except OSError:
        return False
    return True


def present(endpoints: Iterable[str], *, ipv6: bool) -> tuple[str, ...]:
    """Leave out endpoints on ::1 on a host without IPv6, if there are others; say so."""
    given = tuple(endpoints)
    left = tuple(endpoint for endpoint in given if ipv6 or IPV6 not in endpoint)
    if not left or left == given:
        return given
    log.info("no IPv6 on this host: applications connect to %s only", ", ".join(left))
    return left
