"""Free ports, so that tests that run side by side do not meet."""

from studies.demo.ports import free_ports


def free_port() -> int:
    """Return a port of the loopback interface that nobody listens on now, and nobody gets for a while."""
    (port,) = free_ports(1)
    return port
