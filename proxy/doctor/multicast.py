"""Whether this host can send to a multicast group on an interface, and hear itself: the message does not leave it."""

import os
import socket
import struct
from contextlib import suppress
from typing import Any

from proxy import clock
from proxy.bridge.radio import Interface, only_link_local
from proxy.doctor.finding import Finding, finding, fine

_WAIT = 1.0
"""A message that this host sends to itself is there within this time [s]."""


def multicast(interface: Interface, group: str) -> Finding:
    """Try the group `group`, an address and a port."""
    name, cure = interface.name, "or set mesh.scouting = false and name the robots in mesh.connect"
    if not interface.multicast:
        return finding("multicast", f"{name} does no multicast: sudo ip link set dev {name} multicast on, {cure}")
    try:
        heard = _loops_back(interface, group)
    except OSError as error:
        return finding("multicast", f"{name} cannot send to {group} ({error.strerror}): give it an address, {cure}")
    if heard and only_link_local(name, group):
        cure = "give it another one, or take a mesh.group of IPv4"
        return finding("multicast", f"{name} has only link-local addresses of IPv6, and Zenoh cannot use them: {cure}")
    if heard:
        return fine("multicast", f"{name}: a message to {group} is heard")
    return finding("multicast", f"{name}: a message to {group} is lost: let it through the firewall, {cure}")


def _loops_back(interface: Interface, group: str) -> bool:
    host, _, port = group.rpartition(":")
    host, sign = host.strip("[]"), os.urandom(16)
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    place: Any = (host, int(port), 0, interface.index) if family == socket.AF_INET6 else (host, int(port))
    with socket.socket(family, socket.SOCK_DGRAM) as heard, socket.socket(family, socket.SOCK_DGRAM) as said:
        heard.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a daemon hears it, too
        heard.bind(place)
        _join(heard, said, host, interface.index)
        said.sendto(sign, place)
        end = clock.monotonic() + _WAIT
        # Others may say more on the group than there are pauses between.
        while (left := end - clock.monotonic()) > 0.0:
            heard.settimeout(left)
            with suppress(TimeoutError):
                if heard.recv(65536) == sign:
                    return True
    return False


def _join(heard: socket.socket, said: socket.socket, host: str, index: int) -> None:
    """Have one socket hear a group on an interface, and the other one speak there no further than this host."""
    if heard.family == socket.AF_INET6:
        group = socket.inet_pton(socket.AF_INET6, host) + struct.pack("@I", index)
        heard.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, group)
        said.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, index)
        said.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_HOPS, 0)
    else:
        group = socket.inet_aton(host) + bytes(4) + struct.pack("@i", index)
        heard.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        said.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, group)
        said.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
