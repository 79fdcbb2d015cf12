"""The two Zenoh sessions: a router for the apps on this robot, a peer for the mesh."""

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

import zenoh

from proxy.errors import PortInUseError, SessionError

MESH_GROUP = "224.0.0.225:7448"
"""Not Zenoh's default group: the mesh session would link to the robot's own app side."""
SOCKET_BUFFER = 65536
"""Socket buffers on the mesh [B]. Large ones hide seconds of queue from the daemon."""
LEASE = 10_000
"""A link from which Zenoh reads nothing for this long is given up [ms]: a process hangs at its other end. Who vanishes
is missed sooner, by `silence`."""
KEEP_ALIVE = 20
"""So many times in a lease a link that is idle is used all the same: a robot that vanishes leaves that unanswered."""
LEASE_UNSEEN = 2000
"""The lease where links may not be TCP, so that the kernel does not know who is silent [ms]."""

BATCH = 8192
"""Largest piece on the mesh [B]. Zenoh's 64 kB takes a slow radio longer than a robot may be silent."""

QUEUES = {
    "size": {"data_high": 8, "data": 8, "data_low": 8},
    "congestion_control": {
        "drop": {"wait_before_drop": 1000, "max_wait_before_drop_fragments": 50_000},
        "block": {"wait_before_close": 2_000_000},
    },
}
"""Zenoh's queues on the mesh: pieces that wait in each, and how long a publication waits for a full link before its
sample is dropped there, one of many pieces as late as by routers, or the link given up [µs]."""
THREADS = "(tx: (worker_threads: 2), rx: (worker_threads: 12), net: (worker_threads: 2), acc: (handover: app))"
"""Both sides share Zenoh's threads. Whoever publishes with BLOCK to an app that hangs keeps two of `rx` for as long as
Zenoh puts up with that app: with so many, five robots that do leave some to the other apps."""
os.environ.setdefault("ZENOH_RUNTIME", THREADS)  # read when the first session of the process opens

PRIVATE = "sendworthy-private-"
"""Marks endpoints that are nobody's business but ours."""

_TCP = ("tcp/", "tls/")
_BUFFERS = f"so_sndbuf={SOCKET_BUFFER};so_rcvbuf={SOCKET_BUFFER}"


def app_options(
    listen: Iterable[str],
    zenoh_options: Mapping[str, Any],
    *,
    connect: Iterable[str] = (),
    scouting: bool = False,
) -> dict[str, Any]:
    """Zenoh configuration of the app side. `zenoh_options` wins over everything else.

    It may `connect` to routers that apps use already, and with `scouting` it answers apps that look for a router.

    Gossip stays on: without it peer-mode apps of one robot do not hear each other. Timestamping stays off: a
    router that stamps also re-stamps what comes from its future. So does shared memory: 16 MB of every app session
    that ever published more than a few kB would stay mapped here for good.
    """
    options: dict[str, Any] = {
        "mode": "router",
        "listen": {"endpoints": list(listen)},
        "connect": _dialled(connect, _SOON),
        "open": AT_ONCE,
        "scouting": {
            "delay": 0,
            "multicast": {"enabled": scouting, "autoconnect": {"router": []}},
            "gossip": {"enabled": True},
        },
        "timestamping": {"enabled": False},
        "transport": {"shared_memory": {"enabled": False}},
        "adminspace": {"enabled": True, "permissions": {"read": True, "write": False}},
    }
    return merged(options, zenoh_options)


def mesh_options(
    listen: Iterable[str],
    connect: Iterable[str],
    *,
    scouting: bool,
    interface: str,
    zenoh_options: Mapping[str, Any],
    relayed: bool = False,
) -> dict[str, Any]:
    """Zenoh configuration of the mesh side. `zenoh_options` wins over everything else.

    With `relayed` robots meet at the routers in `connect`. To those we are a router too: a client could not tell its
    mirror session what others declare.

    Without `scouting` only `connect` is dialled: gossip would make peers connect around what is between them.
    The start waits for nobody: who cannot be reached is retried for ever.
    """
    listen, connect = list(listen), list(connect)
    autoconnect = ["peer"] if scouting else []
    options: dict[str, Any] = {
        "mode": "router" if relayed else "peer",
        "listen": {"endpoints": [bounded(endpoint) for endpoint in listen]},
        "connect": _dialled((bounded(endpoint) for endpoint in connect), _PATIENTLY),
        "open": AT_ONCE,
        "scouting": {
            "multicast": {
                "enabled": scouting,
                "address": MESH_GROUP,
                "interface": interface,
                "autoconnect": {"peer": autoconnect},
            },
            "gossip": {"enabled": True, "autoconnect": {"peer": autoconnect}},
        },
        "timestamping": {"enabled": False},
        "transport": {
            "shared_memory": {"enabled": False},
            "link": {
                "tx": {**_lease([*listen, *connect], zenoh_options), "batch_size": BATCH, "queue": QUEUES},
                # For links that scouting finds; endpoints carry their own.
                "tcp": {"so_sndbuf": SOCKET_BUFFER, "so_rcvbuf": SOCKET_BUFFER},
            },
        },
    }
    return merged(options, zenoh_options)


def mirror_options(mode: str, endpoint: str, zenoh_options: Mapping[str, Any]) -> dict[str, Any]:
    """Zenoh configuration of the mirror session of one with `zenoh_options`, whose authentication it shares."""
    auth = zenoh_options.get("transport", {}).get("auth", {})
    return {
        "mode": mode,
        "listen": {"endpoints": []},
        "connect": {"endpoints": [endpoint], "timeout_ms": 5000, "exit_on_failure": True},
        "open": AT_ONCE,
        "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "timestamping": {"enabled": False},
        "transport": {"shared_memory": {"enabled": False}, "auth": auth},
    }


def bounded(endpoint: str) -> str:
    """`endpoint` with small socket buffers, unless it is not TCP or says its own."""
    if not endpoint.startswith(_TCP) or "so_sndbuf" in endpoint or "so_rcvbuf" in endpoint:
        return endpoint
    return f"{endpoint}{';' if '#' in endpoint else '#'}{_BUFFERS}"


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Lay `over` upon `base`, table by table; anything but a table replaces what was there."""
    result = dict(base)
    for key, value in over.items():
        below = result.get(key)
        both = isinstance(below, Mapping) and isinstance(value, Mapping)
        result[key] = merged(below, value) if both else value  # type: ignore[arg-type] # `both` says so
    return result


def open_session(options: Mapping[str, Any], side: str) -> zenoh.Session:
    """Open a session; `side` ("app" or "mesh") names it in errors.

    Raises `PortInUseError` when a listen endpoint is taken, `SessionError` for anything else Zenoh refuses.
    """
    shown = [endpoint for endpoint in options["listen"]["endpoints"] if PRIVATE not in endpoint]
    endpoints = ", ".join(endpoint.split("#")[0] for endpoint in shown)
    try:
        return zenoh_session(options)
    except zenoh.ZError as error:
        if "in use" in str(error):
            raise PortInUseError(
                f"{side}.listen: {endpoints}: port in use; another Zenoh router or daemon runs here already"
            ) from error
        raise SessionError(f"{side}: cannot open a Zenoh session on {endpoints}: {reason_of(error)}") from error


def zenoh_session(options: Mapping[str, Any]) -> zenoh.Session:
    """Open a session with these options. Raises `zenoh.ZError`."""
    return zenoh.open(zenoh.Config.from_json5(json.dumps(options)))


def reason_of(error: zenoh.ZError) -> str:
    """Return what Zenoh says, without where in its sources it says so."""
    return str(error).split(" at /")[0]


AT_ONCE = {"return_conditions": {"connect_scouted": False, "declares": False}}
"""Opening a session waits for nobody."""


def _lease(endpoints: Iterable[str], zenoh_options: Mapping[str, Any]) -> dict[str, int]:
    """Zenoh's lease of links to and from these endpoints; none of ours where it is configured."""
    if "lease" in zenoh_options.get("transport", {}).get("link", {}).get("tx", {}):
        return {}
    seen = all(endpoint.startswith(_TCP) for endpoint in endpoints)
    return {"lease": LEASE, "keep_alive": KEEP_ALIVE} if seen else {"lease": LEASE_UNSEEN}


def _dialled(endpoints: Iterable[str], retry: Mapping[str, Any]) -> dict[str, Any]:
    return {"endpoints": list(endpoints), "timeout_ms": -1, "exit_on_failure": False, "retry": retry}


_SOON = {"period_init_ms": 100, "period_max_ms": 200, "period_increase_factor": 1.5}
_PATIENTLY = {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 1.5}
