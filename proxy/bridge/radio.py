"""Which network interface is the radio, when the configuration leaves it open."""

import fcntl
import socket
import struct

from proxy.errors import SessionError

AUTO = "auto"
_READ_FLAGS = 0x8913
"""SIOCGIFFLAGS of Linux."""
_UP, _LOOPBACK, _RUNNING, _MULTICAST = 0x1, 0x8, 0x40, 0x1000


def interface_of(configured: str) -> str:
    """Return `configured`, or for "auto" the only interface that can do multicast. Raises `SessionError`.

    Between several nobody but the operator knows which one is the radio; samples sent on another reach no robot.
    """
    if configured != AUTO:
        return configured
    found = multicast_interfaces()
    if len(found) == 1:
        return found[0]
    known = f"there are {', '.join(found)}" if found else "there is none that is up and can do multicast"
    raise SessionError(f'mesh.interface: to broadcast, name the interface of the radio instead of "auto": {known}')


def multicast_interfaces() -> list[str]:
    """Return the interfaces that are up, have a carrier and can do multicast; never loopback."""
    wanted = _UP | _RUNNING | _MULTICAST
    return [name for _, name in socket.if_nameindex() if _flags(name) & (wanted | _LOOPBACK) == wanted]


def _flags(interface: str) -> int:
    """Return the flags of an interface; none when it has just gone."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            answer = fcntl.ioctl(probe, _READ_FLAGS, struct.pack("16sH14x", interface.encode(), 0))
        except OSError:
            return 0
    return int(struct.unpack("16sH14x", answer)[1])
