"""Whether robots can be found and heard over the radio: its interface, multicast on it, its power save."""

import socket
from collections.abc import Iterator

from proxy.bridge.radio import AUTO, Interface, interface_of, multicast_interfaces
from proxy.bridge.sessions import MESH_GROUP
from proxy.config import MeshConfig
from proxy.doctor.finding import Finding, finding, fine
from proxy.doctor.multicast import multicast
from proxy.doctor.power_save import power_save
from proxy.errors import SessionError


def radio(mesh: MeshConfig, *, running: bool) -> Iterator[Finding]:
    """Look at the interfaces of `mesh`. While a daemon is `running`, nothing is sent to where it hears samples."""
    found = [*_unclear(mesh), *(text for name in _named(mesh) for text in _unusable(name, mesh))]
    usable = [interface for name in _candidates(mesh) if (interface := Interface.of(name)) and interface.up]
    yield from (finding("interface", text) for text in found)
    if not found:
        yield fine("interface", f"{', '.join(each.name for each in usable) or mesh.interface}: up")
    groups = [*[MESH_GROUP] * mesh.scouts, *[mesh.group] * (mesh.transport == "broadcast" and not running)]
    for interface in usable:
        yield from (multicast(interface, group) for group in groups)
        yield from power_save(interface.name)


def _named(mesh: MeshConfig) -> list[str]:
    return [] if mesh.interface == AUTO else mesh.interface.split(",")


def _candidates(mesh: MeshConfig) -> list[str]:
    """Return the interfaces that may be the radio; of those that nobody named, the ones that Zenoh would take."""
    addressed = (name for name in multicast_interfaces() if (found := Interface.of(name)) and found.address)
    return _named(mesh) or list(addressed)


def _unclear(mesh: MeshConfig) -> Iterator[str]:
    """Say what is wrong where an interface is needed and none is named."""
    if mesh.interface != AUTO:
        return
    if mesh.transport == "broadcast":
        try:
            interface_of(mesh.interface)
        except SessionError as error:
            yield str(error)
    elif mesh.scouts and not _candidates(mesh):
        yield "there is none that is up and has an address: bring up the radio, or name it in mesh.interface"


def _unusable(name: str, mesh: MeshConfig) -> Iterator[str]:
    """Say what is wrong with an interface that is named, or with an address that stands in its place."""
    interface = Interface.of(name)
    if interface is None:
        if not _address_here(name):
            known = ", ".join(other for _, other in socket.if_nameindex())
            yield f"there is no {name} (but {known}): plug it in, or correct mesh.interface"
    elif not interface.up:
        yield f"{name} is down: sudo ip link set dev {name} up"
    elif not interface.running:
        yield f"{name} has no carrier: have it join the network of the robots"
    elif mesh.scouts and not interface.address:
        yield f"{name} has no IPv4 address: sudo ip address add 10.0.0.1/24 dev {name}, say"


def _address_here(text: str) -> bool:
    try:
        family, _, _, _, place = socket.getaddrinfo(text, 0, type=socket.SOCK_DGRAM, flags=socket.AI_NUMERICHOST)[0]
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.bind(place)
    except OSError:
        return False
    return True
