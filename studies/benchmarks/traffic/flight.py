"""A flight: daemons and applications as processes of one machine, and what happened, as they and the links noted it."""

import json
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from proxy.commands.client import connected
from proxy.profiling.profile import Profile
from proxy.profiling.request import SECONDS, Request
from studies.benchmarks.resources import processor_time
from studies.benchmarks.traffic.agenda import Agenda
from studies.demo.layout import OPERATOR, Node, lay_out, pairs
from studies.demo.nodes import start_daemons, start_routers
from studies.demo.processes import Process, Troupe

PATIENCE = 30.0
"""How long a process may take to get ready [s]."""
LEAD = 0.5
"""The applications are told the start time this long ahead [s]."""
ROUTER = "router"
"""The mode of a flight with plain Zenoh routers in place of the daemons."""
LINGER = 1.0
"""What was published last has so long to arrive [s]."""

Crossing = tuple[float, str, str, int, int, list[Sequence[int]]]
Name = tuple[int, int, int]
"""Of a sample: robot, stream, number."""


@dataclass(frozen=True, slots=True)
class Published:
    """A sample of an application: when it was due and when it was published [s], and its size [B]."""

    size: int
    due: float
    t_gen: float


@dataclass(frozen=True, slots=True)
class Flight:
    """What happened. Times are seconds since the start.

    `crossed` are the batches on all links, in order: time, source, sink, bytes, bytes of what daemons tell each other,
    and the samples that begin there (robot, stream, number, size). `processor` is what each daemon took of the
    processor from the start to the end [s], `statuses` what each says at the end, `profile` where the time of the first
    robot's went (None of a router). `load` is the machine's mean load of the last minute, before and after.
    """

    seconds: float
    published: Mapping[Name, Published]
    received: Mapping[Name, float]
    crossed: Sequence[Crossing]
    processor: Mapping[str, float]
    statuses: Mapping[str, Any]
    profile: Profile | None
    load: tuple[float, float]


def fly(agenda: Agenda, spec: str, *, mode: str = "enforce", flags: Sequence[str] = ()) -> Flight:
    """Let daemons of this mode, with these further `flags`, carry what applications publish; or plain routers."""
    nodes = lay_out(len(agenda.robots))
    with TemporaryDirectory(prefix="sendworthy-traffic-") as name:
        folder, load = Path(name), os.getloadavg()[0]
        with Troupe(folder) as troupe:
            dials = _start_links(troupe, nodes, folder)
            if mode == ROUTER:
                daemons = start_routers(troupe, nodes, dials)
            else:
                daemons = start_daemons(troupe, nodes, dials, spec, folder, mode=mode, flags=flags)
            applications = start_applications(troupe, nodes, agenda, folder)
            start = time.monotonic() + LEAD
            for application in applications[1:]:
                application.tell(start)
            with ThreadPoolExecutor(1) as beside:
                profile = None if mode == ROUTER else beside.submit(_profile, nodes[1], start, agenda.seconds)
                processor = _processor(troupe, nodes, daemons, start, agenda.seconds)
            time.sleep(LINGER)
            statuses = {} if mode == ROUTER else {node.name: _status(node) for node in nodes}
        crossed, published, received = _read(folder, agenda, start)
        loads = (load, os.getloadavg()[0])
        found = profile.result() if profile else None
        return Flight(agenda.seconds, published, received, crossed, processor, statuses, found, loads)


def _start_links(troupe: Troupe, nodes: tuple[Node, ...], folder: Path) -> dict[str, list[str]]:
    """Start what is between the nodes; return which endpoints each dials."""
    linked = list(pairs(nodes))
    command = ["-m", "studies.benchmarks.traffic.between", "--log", str(folder / "crossed.json")]
    for dialer, target in linked:
        command += ["--pair", f"{dialer.name},{target.name},{target.mesh_port}"]
    ports = troupe.start("between", *command).hear(PATIENCE)["ports"]
    dials: dict[str, list[str]] = {node.name: [] for node in nodes}
    for (dialer, _), port in zip(linked, ports, strict=True):
        dials[dialer.name].append(f"tcp/127.0.0.1:{port}")
    return dials


def start_applications(troupe: Troupe, nodes: tuple[Node, ...], agenda: Agenda, folder: Path) -> list[Process]:
    """Start the operator's application and one for each robot, in the order of the nodes; return when all are ready."""
    applications = [_application(troupe, nodes[0], folder, "listen")]
    applications[0].hear(PATIENCE)
    for robot, node in enumerate(nodes[1:]):
        file = folder / f"agenda-{node.name}.json"
        file.write_text(json.dumps(agenda.of(robot, node.name)))
        applications.append(_application(troupe, node, folder, "publish", "--agenda", str(file)))
    for application in applications[1:]:
        application.hear(PATIENCE)
    return applications


def _application(troupe: Troupe, node: Node, folder: Path, role: str, *options: str) -> Process:
    log = str(folder / f"application-{node.name}.jsonl")
    command = ("-m", "studies.benchmarks.traffic.application", role, "--connect", node.app_endpoint, "--log", log)
    return troupe.start(f"application-{node.name}", *command, *options)


def _processor(
    troupe: Troupe, nodes: Sequence[Node], daemons: Sequence[Process], start: float, seconds: float
) -> dict[str, float]:
    """Wait until the flight is over; return what each daemon took of the processor meanwhile [s]."""
    time.sleep(max(0.0, start - time.monotonic()))
    before = [processor_time(daemon.pid) for daemon in daemons]
    while (left := start + seconds - time.monotonic()) > 0:
        time.sleep(min(left, 1.0))
        troupe.check()
    after = [processor_time(daemon.pid) for daemon in daemons]
    return {node.name: last - first for node, first, last in zip(nodes, before, after, strict=True)}


def _profile(node: Node, start: float, seconds: float) -> Profile:
    """Return the profile of a flight, or of its beginning."""
    time.sleep(max(0.0, start - time.monotonic()))
    with connected(node.app_endpoint) as client:
        return client.profile(node.name, Request(min(seconds, SECONDS[1])))


def _status(node: Node) -> dict[str, Any]:
    with connected(node.app_endpoint) as client:
        return dict(client.status(node.name)[0])


def _read(
    folder: Path, agenda: Agenda, start: float
) -> tuple[list[Crossing], dict[Name, Published], dict[Name, float]]:
    """Return what crossed, what was published and what was received, in seconds since the start."""
    published: dict[Name, Published] = {}
    received: dict[Name, float] = {}
    for robot in range(len(agenda.robots)):
        for stream, number, size, due, t in _log(folder, f"application-r{robot + 1}"):
            published[robot, stream, number] = Published(size, due - start, t - start)
    for robot, stream, number, _, _, t in _log(folder, f"application-{OPERATOR}"):
        received.setdefault((robot, stream, number), t - start)
    noted = json.loads((folder / "crossed.json").read_text())
    crossed = sorted(((t - start, *rest) for t, *rest in noted), key=lambda each: each[0])
    return crossed, published, received


def _log(folder: Path, name: str) -> Iterator[Any]:
    with (folder / f"{name}.jsonl").open() as lines:
        yield from map(json.loads, lines)
