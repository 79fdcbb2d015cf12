"""Which network interface is the radio, when the configuration leaves it open."""

import errno
import fcntl
import ipaddress
import os
import socket
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from proxy.errors import SessionError

AUTO = "auto"
_READ_FLAGS, _READ_ADDRESS = 0x8913, 0x8915
"""SIOCGIFFLAGS and SIOCGIFADDR of Linux."""
_ADDRESSES, _LINK_LOCAL = Path("/proc/net/if_inet6"), "20"
"""Where Linux lists addresses of IPv6, and the scope there of those of one link."""
_UP, _LOOPBACK, _RUNNING, _MULTICAST = 0x1, 0x8, 0x40, 0x1000


def interface_of(configured: str, known: str = "") -> str:
    """Return `configured`, or for "auto" the only interface that can do multicast. Raises `SessionError`.

    Between several nobody but the operator knows which one is the radio; samples sent on another reach no robot. One
    that is `known` to be the radio stays so when others come.
    """
    if configured != AUTO:
        return configured
    found = multicast_interfaces()
    if known in found:
        return known
    if len(found) == 1:
        return found[0]
    what = f"there are {', '.join(found)}" if found else "there is none that is up and can do multicast"
    raise SessionError(f'mesh.interface: to broadcast, name the interface of the radio instead of "auto": {what}')


def multicast_interfaces() -> list[str]:
    """Return the interfaces that are up, have a carrier and can do multicast; never loopback."""
    wanted = _UP | _RUNNING | _MULTICAST
    return [name for _, name in socket.if_nameindex() if _flags(name) & (wanted | _LOOPBACK) == wanted]


@dataclass(frozen=True, slots=True)
class Interface:
    """What the kernel says of a network interface."""

    name: str
    index: int
    up: bool
    running: bool
    multicast: bool
    address: bool

    @classmethod
    def of(cls, name: str) -> Self | None:
        """Ask for one; None when there is none of that name."""
        index = {known: number for number, known in socket.if_nameindex()}.get(name)
        if index is None:
            return None
        flags = _flags(name)
        up, running, multicast = (bool(flags & flag) for flag in (_UP, _RUNNING, _MULTICAST))
        return cls(name, index, up, running, multicast, _has_address(name))


def only_link_local(interface: str, group: str) -> bool:
    """Whether an interface has no address from which Zenoh can send to a `group` of IPv6: its own are link-local."""
    if not group.startswith("[") or _is_address(interface):
        return False
    return all(scope == _LINK_LOCAL or name != interface for *_, scope, _, name in _listed())


def index_of(interface: str) -> int:
    """Return the number of an interface by its name, or by an address of IPv6 that it has. Raises OSError."""
    if not _is_address(interface):
        return socket.if_nametoindex(interface)
    wanted = ipaddress.ip_address(interface).packed.hex()
    for address, number, *_ in _listed():
        if address == wanted:
            return int(number, 16)
    raise OSError(errno.EADDRNOTAVAIL, os.strerror(errno.EADDRNOTAVAIL))


def _listed() -> list[list[str]]:
    try:
        return [row.split() for row in _ADDRESSES.read_text().splitlines()]
    except OSError:  # a kernel without IPv6
        return []


class Scouted:
    """Where other robots are looked for: Zenoh takes the interfaces that have an address when its session opens.

    `configured` is "auto", or what the configuration names.
    """

    def __init__(self, configured: str) -> None:
        self._configured = configured
        self._taken = self._usable()
        self._addresses = {name: _address(name) for name in self._taken}

    def warnings(self) -> list[str]:
        """Say where robots are not looked for, and what to do."""
        late = sorted(self._usable() - self._taken)
        if late:
            names = " and ".join(late)
            return [f"mesh.interface: {names} came up after the daemon did; to find robots there, restart it"]
        for name, before in sorted(self._addresses.items()):
            now = _address(name)
            if before and now and now != before:
                return [f"mesh.interface: {name} had {before} and has {now} now; to find robots, restart the daemon"]
        if not self._taken:
            which = "no interface" if self._configured == AUTO else f'no interface "{self._configured}" with an address'
            return [f"mesh.interface: there is {which}, so no robots are found; restart the daemon when there is one"]
        return []

    def _usable(self) -> set[str]:
        if self._configured == AUTO:
            return {name for name in multicast_interfaces() if _has_address(name)}
        # Names of interfaces; whatever else stands there, such as addresses, is for Zenoh to judge.
        known = {name for _, name in socket.if_nameindex()}
        named = set(self._configured.split(","))
        return {name for name in named if _has_address(name) or (name not in known and _is_address(name))}


def _address(interface: str) -> str:
    """Return the address of an interface; nothing where it has none."""
    answer = _asked(_READ_ADDRESS, interface)
    return "" if answer is None else socket.inet_ntoa(answer[20:24])


def _has_address(interface: str) -> bool:
    return _asked(_READ_ADDRESS, interface) is not None


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


def _flags(interface: str) -> int:
    """Return the flags of an interface; none when it has just gone."""
    answer = _asked(_READ_FLAGS, interface)
    return 0 if answer is None else int(struct.unpack("16sH14x", answer)[1])


def _asked(what: int, interface: str) -> bytes | None:
    """Ask the kernel about an interface; None when it has nothing of the kind, or there is no such interface."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            return fcntl.ioctl(probe, what, struct.pack("16sH14x", interface.encode()[:15], 0))
        except OSError:
            return None
