"""Looks at the connections between the demo's processes, to see whether any goes around the medium."""

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

ESTABLISHED = "01"
"""State of a connection in /proc/net/tcp (<net/tcp_states.h>)."""


def connections(owners: Mapping[int, str]) -> list[tuple[str, str]]:
    """Return every TCP connection between two different owners, once; `owners` maps process ids to names."""
    inodes = {inode: name for pid, name in owners.items() for inode in _sockets(pid)}
    ends = {}
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        path = Path(table)
        for line in path.read_text().splitlines()[1:] if path.exists() else ():
            fields = line.split()
            if fields[3] == ESTABLISHED and fields[9] in inodes:
                ends[fields[1], fields[2]] = inodes[fields[9]]
    found = []
    for (local, remote), owner in ends.items():
        other = ends.get((remote, local))
        if other is not None and owner < other:
            found.append((owner, other))
    return sorted(found)


def around(found: Iterable[tuple[str, str]], medium: str, allowed: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the connections that neither end at the medium nor are those of an app with its own node."""
    known = {frozenset(pair) for pair in allowed}
    return [pair for pair in found if medium not in pair and frozenset(pair) not in known]


def _sockets(pid: int) -> set[str]:
    """Return the inodes of the sockets of a process; none when it has ended."""
    inodes = set()
    try:
        for entry in os.scandir(f"/proc/{pid}/fd"):
            target = _target(entry.path)
            if target.startswith("socket:["):
                inodes.add(target[8:-1])
    except FileNotFoundError:
        return set()
    return inodes


def _target(path: str) -> str:
    try:
        return str(Path(path).readlink())
    except FileNotFoundError:
        return ""
