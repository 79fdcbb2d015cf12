"""Brings what a run needs on stage: the medium, and each robot's and the operator's apps."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from studies.demo.air import Air
from studies.demo.footage import Footage
from studies.demo.layout import Node, pairs
from studies.demo.processes import Process, Troupe

PATIENCE = 20.0
"""How long a process may take to get ready [s]."""
MEDIUM = "medium"


@dataclass(frozen=True, slots=True)
class Cast:
    """What robots' apps do for how many `seconds`; drawn from `seed` or, where there is any, replayed `footage`."""

    robots: int
    seconds: float
    seed: int
    footage: Sequence[Footage] = ()
    keep: float = 1.0
    """Cameras send frames at random, with this probability."""


@dataclass(slots=True)
class Apps:
    """The apps that run, and to whose node each belongs."""

    cameras: list[Process] = field(default_factory=list)
    others: list[Process] = field(default_factory=list)
    owners: dict[str, int] = field(default_factory=dict)
    """The number of an app's node, by its name."""

    @property
    def all(self) -> list[Process]:
        """Return all apps."""
        return [*self.others, *self.cameras]


def start_medium(
    troupe: Troupe, nodes: tuple[Node, ...], air: Air, log: Path | None
) -> tuple[Process, dict[str, list[str]]]:
    """Start the medium; return it, and which endpoints each node dials."""
    linked = list(pairs(nodes))
    command = ["-m", "studies.demo.relay", "--rate", str(8 * air.limit), "--latency", str(air.latency)]
    command += ["--loss", str(air.loss), *_logged(log)]
    for dialer, target in linked:
        command += ["--pair", f"{dialer.name},{target.name},{target.mesh_port}"]
    medium = troupe.start(MEDIUM, *command)
    ports = medium.hear(PATIENCE)["ports"]
    dials: dict[str, list[str]] = {node.name: [] for node in nodes}
    for (dialer, _), port in zip(linked, ports, strict=True):
        dials[dialer.name].append(f"tcp/127.0.0.1:{port}")
    return medium, dials


def start_robots(troupe: Troupe, nodes: Sequence[Node], cast: Cast, folder: Path | None, *, told: bool = False) -> Apps:
    """Start the robots' apps; return when all are ready. What they published is noted in `folder`, if any.

    Where cameras are `told`, red objects are there when somebody says so, and not by the seed.
    """
    apps = Apps()
    common = ["--robots", str(cast.robots), "--seconds", str(cast.seconds), "--seed", str(cast.seed)]
    for node in nodes[1:]:
        robot = ["--robot", str(node.number - 1), *common]
        camera = ["--keep", str(cast.keep), *(["--told"] if told else [])]
        if cast.footage:
            footage = cast.footage[node.number - 1]
            camera += ["--footage", str(footage.path), "--offset", str(footage.offset)]
        apps.cameras.append(start_app(troupe, "camera", node, folder, [*robot, *camera]))
        apps.others.append(start_app(troupe, "telemetry", node, folder, robot))
        apps.owners |= {apps.cameras[-1].name: node.number, apps.others[-1].name: node.number}
    for app in apps.all:
        app.hear(PATIENCE)
    return apps


def start_app(troupe: Troupe, kind: str, node: Node, folder: Path | None, arguments: Sequence[str]) -> Process:
    """Start an app of a node: the module of this name. It is not ready yet."""
    name = f"{kind}-{node.name}"
    log = None if folder is None else folder / f"{name}.jsonl"
    command = ["-m", f"studies.demo.{kind}", "--connect", node.app_endpoint, *_logged(log), *arguments]
    return troupe.start(name, *command, within=node.namespace)


def _logged(log: Path | None) -> list[str]:
    return [] if log is None else ["--log", str(log)]
