"""What stands between a robot's apps and the medium: a stock Zenoh router, or our daemon."""

import json
import re
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from proxy.commands.client import NoAnswerError, connected
from studies.demo.events import Counts, Event
from studies.demo.layout import OPERATOR, Node
from studies.demo.processes import DemoError, Process, Troupe, entering

WITHOUT, DOWNSAMPLED, RANDOM, WITH = "without", "downsampled", "random", "with"
PHASES = WITHOUT, DOWNSAMPLED, WITH
"""In the order of the runs: what the cameras publish in the first one tells how far the others have to go down."""
SHARE = 0.9
"""The spec's limit as a share of the medium."""
WINDOW = 0.95
"""The window of the spec's constraint [s]: no multiple of the frame period, which would cost a frame per window."""
CAMERAS = "robot/*/camera"
"""The key of frames."""
ASSEMBLY = 20.0
"""How long the nodes may take to find each other [s]."""

SURVEILLANCE = """\
# What a camera frame is worth to the operator: more when it shows something red (Eq. 9), as long as that is there.
# A position or a charge is worth little beside it, and takes next to nothing.
version = 1

[[constraint]]
kind = "throughput"
limit = "{limit:.0f} bit/s"
window = {window}

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "current"
weight = 1.0
utility = {{ kind = "video" }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}
forecast = {{ features = "last" }}

[[information_type]]
name = "position"
keys = ["robot/*/position"]
aggregation = "most_recent"
weight = 0.05
utility = {{ kind = "linear", u0 = 1.0, slope = 0.5 }}

[[information_type]]
name = "battery"
keys = ["robot/*/battery"]
aggregation = "most_recent"
weight = 0.05
utility = {{ kind = "linear", u0 = 1.0, slope = 0.1 }}
"""
LIMIT = re.compile(r'(kind = "throughput"\s+limit = )"[^"]*"')
"""Where a spec says what may be sent."""


def with_limit(spec: str, limit: float) -> str:
    """Return the spec with another limit [bit/s]."""
    return LIMIT.sub(rf'\g<1>"{limit:.0f} bit/s"', spec)


def start_routers(
    troupe: Troupe, nodes: Sequence[Node], dials: Mapping[str, list[str]], frequency: float | None = None
) -> list[Process]:
    """Start a stock router for each node; return when all are linked. `dials`: endpoints by node.

    With a `frequency` [1/s] Zenoh's downsampling lets at most so many frames a second out of a robot's router.
    """
    routers = []
    for node in nodes:
        command = ["-m", "studies.demo.stock_router", "--others", str(len(nodes) - 1)]
        command += ["--listen", node.app_endpoint, "--listen", node.mesh_endpoint]
        for endpoint in dials[node.name]:
            command += ["--connect", endpoint]
        if frequency is not None and node.name != OPERATOR:
            command += ["--downsample", CAMERAS, str(frequency)]
        routers.append(troupe.start(f"router-{node.name}", *command, within=node.namespace))
    for router in routers:
        router.hear(ASSEMBLY)
    return routers


def start_daemons(
    troupe: Troupe,
    nodes: Sequence[Node],
    dials: Mapping[str, list[str]],
    spec: str,
    folder: Path,
    *,
    mode: str = "enforce",
    flags: Sequence[str] = (),
    own_flags: Mapping[str, Sequence[str]] | None = None,
) -> list[Process]:
    """Start our daemon for each node, with `spec` and further `flags`; return when they know each other.

    Each has flags of its own besides, by the node's name.
    """
    file = folder / "specs.toml"
    file.write_text(spec)
    daemons = []
    for node in nodes:
        config = folder / f"{node.name}.toml"
        config.write_text(_config(node, dials[node.name], file, mode))
        command = ("-m", "proxy.cli", "run", "--config", str(config), *flags, *(own_flags or {}).get(node.name, ()))
        daemons.append(troupe.start(f"daemon-{node.name}", *command, within=node.namespace))
    deadline = time.monotonic() + ASSEMBLY
    for node in nodes:
        while not _assembled(node, len(nodes) - 1):
            troupe.check()
            if time.monotonic() > deadline:
                words = " ".join(daemon.last_words() for daemon in daemons)
                raise DemoError(f"the daemons did not find each other within {ASSEMBLY:.0f} s: {words}")
            time.sleep(0.1)
    return daemons


def count(phase: str, nodes: Sequence[Node]) -> list[Event]:
    """Ask every robot's daemon what it counted."""
    events: list[Event] = []
    for node in nodes[1:]:
        counts = status(node)["counts"]
        numbers = (int(counts[name]) for name in ("in", "forwarded", "dropped", "queued"))
        events.append(Counts(phase, node.name, *numbers))
    return events


def status(node: Node) -> dict[str, Any]:
    """Return what a node's daemon says of itself. Raises NoAnswerError."""
    if node.namespace is None:
        with connected(node.app_endpoint) as client:
            return dict(client.status(node.name)[0])
    # It listens for its apps where only they are.
    asking = [*entering(node.namespace), sys.executable, "-m", "proxy.cli", "status", "--json"]
    asking += ["--connect", node.app_endpoint, "--robot", node.name]
    asked = subprocess.run(asking, capture_output=True, text=True, check=False)
    if asked.returncode:
        raise NoAnswerError(asked.stderr.strip())
    found = json.loads(asked.stdout)
    return dict(found[0] if isinstance(found, list) else found)


def _config(node: Node, dials: Sequence[str], spec: Path, mode: str) -> str:
    """Return the daemon's configuration; a JSON string or list is a TOML one too."""
    return "\n".join(
        [
            f"robot = {json.dumps(node.name)}",
            f"mode = {json.dumps(mode)}",
            "[app]",
            f"listen = {json.dumps([node.app_endpoint])}",
            "[mesh]",
            f"listen = {json.dumps([node.mesh_endpoint])}",
            f"connect = {json.dumps(dials)}",
            "scouting = false",
            "[specs]",
            f"path = {json.dumps(str(spec))}",
            "",
        ]
    )


def _assembled(node: Node, others: int) -> bool:
    """Whether the node's daemon answers and knows all others."""
    try:
        return len(status(node)["peers"]) >= others
    except NoAnswerError:
        return False
