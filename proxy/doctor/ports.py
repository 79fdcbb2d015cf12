"""Whether the ports of this robot are free, or those of its own daemon."""

import errno
import re
import socket
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from proxy.config_values import HOST_AND_PORT
from proxy.doctor.finding import Finding, finding, fine, unknown

_STREAMS = {"tcp": True, "tls": True, "ws": True, "udp": False, "quic": False}
"""Protocols by whether they listen on a port of TCP or of UDP."""
_LISTENS = "0A"
"""How /proc/net/tcp shows a socket that listens."""
Port = tuple[bool, int]
"""Whether it is one of TCP, and its number."""


def ports(listen: Iterable[str], ours: Iterable[str]) -> Iterator[Finding]:
    """Look at the ports of the endpoints `listen`; the running daemon has those of `ours`."""
    taken = {port: endpoint for endpoint in ours if (port := _port(endpoint)) is not None}
    for endpoint in listen:
        port = _port(endpoint)
        if port is None or not port[1]:
            continue
        if port in taken:
            yield fine("port", f"{endpoint}: the daemon of this robot listens there")
        else:
            yield _tried(endpoint, *port)


def _tried(endpoint: str, stream: bool, number: int) -> Finding:  # noqa: FBT001 - a part of the port
    kind = socket.SOCK_STREAM if stream else socket.SOCK_DGRAM
    try:
        host = _address(endpoint)["host"].strip("[]")
        family, _, _, _, place = socket.getaddrinfo(host, number, type=kind, flags=socket.AI_PASSIVE)[0]
        with socket.socket(family, kind) as probe:
            if stream:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as Zenoh does
            probe.bind(place)
    except socket.gaierror as error:
        return finding("port", f"{endpoint}: the host has no address here ({error.strerror}): correct the endpoint")
    except OSError as error:
        return _refused(endpoint, number, error, stream=stream)
    return fine("port", f"{endpoint}: free")


def _refused(endpoint: str, number: int, error: OSError, *, stream: bool) -> Finding:
    match error.errno:
        case errno.EADDRINUSE:
            who = _holder(number) if stream else ""
            return finding("port", f"{endpoint}: another process{who} has this port: end it, or set another port")
        case errno.EADDRNOTAVAIL:
            return finding("port", f"{endpoint}: this host has no such address: correct it, or bring its interface up")
        case errno.EACCES:
            return unknown("port", f"{endpoint}: only root may try a port below 1024: run it with sudo")
        case _:
            return finding("port", f"{endpoint}: nobody can listen there: {error.strerror}: correct the endpoint")


def _address(endpoint: str) -> "re.Match[str]":
    found = HOST_AND_PORT.fullmatch(re.split("[?#]", endpoint.partition("/")[2], maxsplit=1)[0])
    assert found is not None, "the configuration takes no other endpoints"  # noqa: S101 - an invariant
    return found


def _port(endpoint: str) -> Port | None:
    protocol = endpoint.partition("/")[0]
    return (_STREAMS[protocol], int(_address(endpoint)["port"])) if protocol in _STREAMS else None


def _holder(port: int) -> str:
    """Return which process listens on a port of TCP, as far as this user may see that."""
    sockets = {f"socket:[{inode}]" for inode in _inodes(port)}
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has ended meanwhile, or belongs to another user
            if sockets.intersection(_open_files(process)):
                return f", {(process / 'comm').read_text().strip()} (pid {process.name}),"
    return ""


def _open_files(process: Path) -> Iterator[str]:
    """Yield what a process has open: it may close one while the others are looked at."""
    for each in (process / "fd").iterdir():
        with suppress(FileNotFoundError):
            yield str(each.readlink())


def _inodes(port: int) -> Iterator[str]:
    for table in ("tcp", "tcp6"):
        with suppress(OSError):  # a kernel without IPv6
            for line in Path("/proc/net", table).read_text().splitlines()[1:]:
                _, local, _, state, *_, inode = line.split()[:10]
                if state == _LISTENS and int(local.rpartition(":")[2], 16) == port:
                    yield inode
