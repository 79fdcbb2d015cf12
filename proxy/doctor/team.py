"""What a running daemon tells of itself, of applications around it, and of the other robots."""

from collections.abc import Iterator, Sequence
from typing import Any

from proxy.bridge.lookout import CURE, Lookout, on_this_host
from proxy.config import Config
from proxy.doctor.finding import Finding, finding, fine, unknown
from proxy.status.warnings import warnings
from proxy.version import version

Status = dict[str, Any]
"""What `sendworthy status --json` shows."""
OTHER = "another version"
"""What a daemon runs that does not say what."""


def team(status: Status, config: Config | None) -> Iterator[Finding]:
    """Look at everything that the daemon here knows. Without a `config` it is compared with none."""
    told = warnings(status)
    yield from _daemon(status, config, [text for text in told if CURE not in text])
    relayed = config is not None and config.mesh.relayed
    yield from _applications(status, [text for text in told if CURE in text], relayed=relayed)
    yield from _peers(status.get("version", OTHER), status.get("peers", ()))


def applications(mesh_interface: str) -> Iterator[Finding]:
    """Look for applications around a daemon that does not run: those that answer everybody on the radio."""
    lookout = Lookout(mesh_interface, ())
    lookout.look()
    yield from _around(lookout.warnings())


def _daemon(status: Status, config: Config | None, told: Sequence[str]) -> Iterator[Finding]:
    if (runs := status.get("version", OTHER)) != version():
        yield finding("daemon", f"{runs} runs, {version()} is installed: sudo systemctl restart sendworthy")
    if config is not None and (differs := _differences(status, config)):
        yield finding("daemon", f"{differs}: restart it, or look with its own files, variables and flags (--config)")
    yield from (finding("daemon", text) for text in told)
    if not told:
        yield fine("daemon", f"robot {status['robot']} in mode {status.get('mode')} warns of nothing")


def _differences(status: Status, config: Config) -> str:
    """Say what the daemon has otherwise than the configuration; a mode may have been switched."""
    told, here = status.get("daemon", {}), {"app": list(config.app.listen), "mesh": list(config.mesh.listens)}
    found = [
        f"{side}.listen {told[side]}, not {listens}"
        for side, listens in here.items()
        if told.get(side, listens) != listens
    ]
    return f"the daemon here has {' and '.join(found)}" if found else ""


def _applications(status: Status, told: Sequence[str], *, relayed: bool) -> Iterator[Finding]:
    """Look for what is linked to the mesh from this host itself, and is no daemon.

    Where all is `relayed` only the routers are that it dials, which may well be on this host.
    """
    known = {peer.get("zid") for peer in status.get("peers", ())}
    links = {link.get("zid"): link.get("destination", "") for link in status.get("daemon", {}).get("links", ())}
    strangers = {zid: place for zid, place in links.items() if zid not in known}
    linked = [
        f"the Zenoh process {zid} of this robot is on the mesh itself, around the daemon, at {place}: {CURE}"
        for zid, place in strangers.items()
        if _here(place) and not relayed and not any(zid in text for text in told)
    ]
    yield from _around([*told, *linked])


def _around(told: Sequence[str]) -> Iterator[Finding]:
    yield from (finding("applications", text) for text in told)
    if not told:
        yield fine("applications", "none is seen around the daemon")


def _here(place: str) -> bool:
    return "/127." in place or "/[::1]" in place or on_this_host(place)


def _peers(here: str, peers: Sequence[Status]) -> Iterator[Finding]:
    """Compare versions and limits; of limits that differ the daemon warns itself."""
    if not peers:
        yield fine("other robots", "none is known")
        return
    others = [peer for peer in peers if peer.get("version") not in {None, here}]
    for peer in others:
        yield finding("versions", f"{peer.get('robot')} runs {peer['version']}, here {here}: install one on all robots")
    if not others:
        yield fine("versions", f"{here} on all {len(peers) + 1} robots")
    if all(peer.get("takes_part", True) for peer in peers):
        yield fine("limits", f"the same on all {len(peers) + 1} robots")


def alone(why: str) -> Iterator[Finding]:
    """Say what cannot be looked at without a daemon."""
    start = "start it (sudo systemctl restart sendworthy), for only a running one knows of other robots"
    yield unknown("daemon", f"{why.partition(';')[0]}: {start}")
