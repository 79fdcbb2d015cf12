"""The two Zenoh sessions: a router for the apps on this robot, a peer for the mesh."""

import json
import os
import re
import stat
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import zenoh

from proxy.bridge.tuning import TUNING
from proxy.config_values import SECURED
from proxy.errors import PortInUseError, SessionError

MESH_GROUP = "224.0.0.225:7448"
"""Not Zenoh's default group: the mesh session would link to the robot's own app side."""


WAITING = dict.fromkeys(("data_high", "data", "data_low"), TUNING.pieces_waiting)
"""How much waits in Zenoh's queues for samples, on each side."""
QUEUES = {
    "size": WAITING,
    "congestion_control": {
        "drop": {
            "wait_before_drop": TUNING.full_link_wait,
            "max_wait_before_drop_fragments": TUNING.full_link_wait_pieces,
        },
        "block": {"wait_before_close": TUNING.full_link_closes},
    },
}
"""Zenoh's queues on the mesh."""
THREADS = (
    f"(tx: (worker_threads: {TUNING.threads_sending}), rx: (worker_threads: {TUNING.threads_receiving}), "
    f"net: (worker_threads: {TUNING.threads_linking}), acc: (handover: app))"
)
"""Zenoh's threads, which both sides share."""
os.environ.setdefault("ZENOH_RUNTIME", THREADS)  # read when the first session of the process opens

PRIVATE = "sendworthy-private-"
"""Marks folders that are nobody's business but ours."""
PLACE = "unixsock-stream//proc/self/fd/"
"""Marks endpoints in these."""

GROUP_IN = stat.S_IRGRP | stat.S_IWGRP
"""What members of its group need to connect to a socket."""

_TCP = ("tcp/", "tls/")
_BUFFERS = f"so_sndbuf={TUNING.socket_buffer};so_rcvbuf={TUNING.socket_buffer}"


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
        "connect": _dialled(connect, TUNING.redial_router),
        "open": AT_ONCE,
        "scouting": {
            "delay": 0,
            "multicast": {"enabled": scouting, "autoconnect": {"router": []}},
            "gossip": {"enabled": True},
        },
        "timestamping": {"enabled": False},
        "transport": {"shared_memory": {"enabled": False}, "link": {"tx": {"queue": {"size": WAITING}}}},
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
        "connect": _dialled((bounded(endpoint) for endpoint in connect), TUNING.redial_mesh),
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
                **_protocols([*listen, *connect]),
                "tx": {**_lease([*listen, *connect], zenoh_options), "batch_size": TUNING.batch, "queue": QUEUES},
                "rx": {"max_message_size": TUNING.largest_message},
                # For links that scouting finds; endpoints carry their own.
                "tcp": {"so_sndbuf": TUNING.socket_buffer, "so_rcvbuf": TUNING.socket_buffer},
            },
        },
    }
    return merged(options, zenoh_options)


def largest_payload(zenoh_options: Mapping[str, Any]) -> int:
    """Return how large a payload may be to cross the mesh [B]; who configures Zenoh's largest message means that."""
    received = zenoh_options.get("transport", {}).get("link", {}).get("rx", {})
    return int(received.get("max_message_size", TUNING.largest_message)) - TUNING.around_payload


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
        "transport": {
            "shared_memory": {"enabled": False},
            "auth": auth,
            "link": {"tx": {"lease": TUNING.lease_inside}},
        },
    }


def _protocols(endpoints: Sequence[str]) -> dict[str, list[str]]:
    """Return which protocols links may have, where all `endpoints` are secured: those, and the one within the process.

    Scouting finds who answers, whatever they speak, and both sides of a plain link would be linked without a word.
    """
    spoken = {endpoint.partition("/")[0] for endpoint in endpoints}
    return {"protocols": [*sorted(spoken), "unixsock-stream"]} if spoken and spoken <= set(SECURED) else {}


def let_group_in(endpoints: Iterable[str]) -> None:
    """Let the group of the daemon connect to sockets that are files: the unit's UMask= leaves them to its user."""
    for endpoint in endpoints:
        protocol, _, place = endpoint.partition("/")
        if protocol == "unixsock-stream":
            with suppress(OSError):
                path = Path(re.split("[?#]", place)[0])
                path.chmod(path.stat().st_mode | GROUP_IN)


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
    shown = [endpoint for endpoint in options["listen"]["endpoints"] if not endpoint.startswith(PLACE)]
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
    return {"lease": TUNING.lease if seen else TUNING.lease_unseen}


def _dialled(endpoints: Iterable[str], redial: tuple[int, int]) -> dict[str, Any]:
    first, last = redial
    retry = {"period_init_ms": first, "period_max_ms": last, "period_increase_factor": TUNING.redial_slower}
    return {"endpoints": list(endpoints), "timeout_ms": -1, "exit_on_failure": False, "retry": retry}
