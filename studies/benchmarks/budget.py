"""What a daemon costs where it has to decide, where it need not, where nothing is to do, and when it starts.

Beside each stands what a plain Zenoh router takes that carries the same.
"""

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from threading import Event

import zenoh

from planner import Linear
from proxy.commands.client import connected
from proxy.profiling.flame import flame
from proxy.profiling.profile import Profile
from proxy.profiling.request import Request
from proxy.profiling.stages import STAGES
from studies.benchmarks.report import Picture, Result, Table
from studies.benchmarks.resources import private_memory, processor_time, resident_memory, threads
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.flight import ROUTER, Flight, fly
from studies.demo.layout import OPERATOR, Node, lay_out, pairs
from studies.demo.nodes import start_daemons, start_routers
from studies.demo.ports import free_ports
from studies.demo.processes import Process, Troupe
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.workloads import MBIT, Workload, mixed

MEGABYTE = 1e6
SETTLING = 3.0
"""A team that has just met tells each other more than one that has not [s]."""
KEY = "r1/odometry"
"""Of what is published first..."""
PUBLISHED_EVERY = 0.005
"""... again and again until it arrives [s]."""
PATIENCE = 30.0
"""How long a start may take [s]."""
SMALL = Kind("odometry", Linear(1.0, 1.0), (200, 200), (116, 116), small=True)
"""So many samples a second as one robot has that moves fast, each as large as most are."""
UNDISPUTED = Workload("undisputed", ((SMALL,),), 100 * MBIT, 0.5)
"""Two daemons, between which there is room for everything."""


@dataclass(frozen=True, slots=True)
class Idle:
    """What a node is that has nothing to do: part of a core, threads, memory in use and that nobody shares [B].

    Memory is that before the profile: what takes it is loaded with the first one.
    """

    core: float
    threads: int
    resident: int
    private: int
    profile: Profile | None


def measure_budget(*, quick: bool) -> list[Result]:
    """Measure, daemons and routers in turn; `quick` takes a minute and tells little."""
    seconds, others, rounds = (4.0, 3, 1) if quick else (15.0, 10, 5)
    flights = {
        (workload.name, mode): fly(draw(workload, seconds, 1), workload.spec(), mode=mode)
        for workload in (mixed(2), UNDISPUTED)
        for mode in ("enforce", ROUTER)
    }
    idle = {mode: _idle(mode, others, seconds) for mode in ("daemon", ROUTER)}
    starts = {mode: [start(mode) for _ in range(rounds)] for mode in ("daemon", ROUTER)}
    contended, undisputed = (flights[name, "enforce"].profile for name in ("mixed", UNDISPUTED.name))
    found: list[Result] = [
        _samples(flights, seconds),
        _idleness(idle, others, seconds),
        _beginnings(starts),
        _stages(contended, undisputed, idle["daemon"].profile),
    ]
    if contended is not None:
        found.append(Picture("Where the time of a daemon goes that has to decide", flame(contended)))
    return found


def start(mode: str) -> float:
    """Return how long a daemon or a router takes from its start until the first sample is through [s]."""
    ports = free_ports(2)
    app, mesh = (f"tcp/127.0.0.1:{port}" for port in ports)
    arrived = Event()
    with (
        TemporaryDirectory(prefix="sendworthy-budget-") as folder,
        _session("peer", listen=mesh) as listener,
        _listening(listener, arrived),
        Troupe(Path(folder)) as troupe,
    ):
        began = time.monotonic()
        _start(troupe, mode, app, mesh, Path(folder))
        with _session("client", connect=app) as publisher:
            while not arrived.wait(PUBLISHED_EVERY):
                publisher.put(KEY, b"x")
                troupe.check()
                if time.monotonic() > began + PATIENCE:
                    raise TimeoutError(f"nothing came through the {mode}")
        return time.monotonic() - began


def _start(troupe: Troupe, mode: str, app: str, mesh: str, folder: Path) -> None:
    if mode == ROUTER:
        command = ("--listen", app, "--connect", mesh, "--others", "0")
        troupe.start("router", "-m", "studies.demo.stock_router", *command)
        return
    (folder / "spec.toml").write_text(UNDISPUTED.spec())
    config = folder / "sendworthy.toml"
    sides = f"[app]\nlisten = {json.dumps([app])}\n[mesh]\nlisten = []\nconnect = {json.dumps([mesh])}\n"
    config.write_text(f'robot = "r1"\nmode = "enforce"\n{sides}scouting = false\n[specs]\npath = "spec.toml"\n')
    troupe.start("daemon", "-m", "proxy.cli", "run", "--config", str(config))


def _session(mode: str, listen: str = "", connect: str = "") -> zenoh.Session:
    """Open an application's session, as soon as there is who it connects to."""
    settings = {
        "mode": mode,
        "listen": {"endpoints": [listen] if listen else []},
        "connect": {
            "endpoints": [connect] if connect else [],
            "timeout_ms": int(PATIENCE * 1e3),
            "retry": {"period_init_ms": 5, "period_max_ms": 5},
        },
        "scouting": {"multicast": {"enabled": False}},
    }
    return zenoh.open(zenoh.Config.from_json5(json.dumps(settings)))


@contextmanager
def _listening(session: zenoh.Session, arrived: Event) -> Iterator[None]:
    def take(_: zenoh.Sample) -> None:
        arrived.set()

    handler = zenoh.handlers.Callback(take, indirect=False)
    with session.declare_subscriber(KEY, handler):
        yield


def _idle(mode: str, others: int, seconds: float) -> Idle:
    """Measure a node among so many others of which none has anything to say."""
    nodes = lay_out(others)
    dials: dict[str, list[str]] = {node.name: [] for node in nodes}
    for dialer, target in pairs(nodes):
        dials[dialer.name].append(target.mesh_endpoint)
    with TemporaryDirectory(prefix="sendworthy-budget-") as folder, Troupe(Path(folder)) as troupe:
        if mode == ROUTER:
            process = start_routers(troupe, nodes, dials)[0]
        else:
            process = start_daemons(troupe, nodes, dials, mixed(others).spec(), Path(folder))[0]
        time.sleep(SETTLING)
        return _measured(process, None if mode == ROUTER else nodes[0], seconds)


def _measured(process: Process, node: Node | None, seconds: float) -> Idle:
    memory = resident_memory(process.pid), private_memory(process.pid)  # before any profile
    began, before = time.monotonic(), processor_time(process.pid)
    profile = None
    if node is None:
        time.sleep(seconds)
    else:
        with connected(node.app_endpoint) as client:
            profile = client.profile(OPERATOR, Request(seconds))
    spent = processor_time(process.pid) - before - (profile.own if profile else 0.0)
    core = spent / (time.monotonic() - began)
    return Idle(core, threads(process.pid), *memory, profile)


def _samples(flights: dict[tuple[str, str], Flight], seconds: float) -> Table:
    rows = []
    for workload, title in (("mixed", "mixed, 2 robots, 1 Mbit/s"), (UNDISPUTED.name, "200 small ones a second")):
        daemon, router = (_each(flights[workload, mode]) for mode in ("enforce", ROUTER))
        rows += [
            (f"{title}: {who}", f"{1e3 * daemon[who]:.2f}", f"{1e3 * router[who]:.2f}") for who in ("robot", OPERATOR)
        ]
    note = (
        f"Flights of {seconds:g} s. Processor time of a robot's daemon or router for a sample that its applications"
        " publish, the profile taken meanwhile not counted; of the operator's for one that comes. A router passes on"
        " all samples, the daemons of *mixed* decide which. The small ones are covered, with a limit of 100 Mbit/s."
    )
    return Table("What a sample costs [ms]", ("traffic", "daemon", "plain router"), tuple(rows), note)


def _each(flight: Flight) -> dict[str, float]:
    """Return what a sample takes of the processor at a robot, in the mean, and at the operator [s]."""
    robots = sum(taken for name, taken in flight.processor.items() if name != OPERATOR)
    own = flight.profile.own if flight.profile else 0.0
    return {
        "robot": (robots - own) / max(len(flight.published), 1),
        OPERATOR: flight.processor[OPERATOR] / max(len(flight.received), 1),
    }


def _idleness(found: dict[str, Idle], others: int, seconds: float) -> Table:
    rows = tuple(
        (
            mode,
            f"{idle.core:.2%}",
            str(idle.threads),
            f"{idle.resident / MEGABYTE:.0f}",
            f"{idle.private / MEGABYTE:.0f}",
        )
        for mode, idle in found.items()
    )
    note = f"Nobody publishes anything. The mean of {seconds:g} s; memory [MB] in use, and in use by nobody else."
    columns = ("node", "of a core", "threads", "resident", "private")
    return Table(f"One that is idle, with {others} others", columns, rows, note)


def _beginnings(found: Mapping[str, Sequence[float]]) -> Table:
    rows = tuple((mode, f"{median(each):.2f}", f"{max(each):.2f}") for mode, each in found.items())
    note = (
        "From the start of the process until a listener that it dials has the first sample of an application that waits"
        " to publish. The router is Zenoh's in a Python process, too."
    )
    return Table("From the start to the first sample [s]", ("node", "median", "longest"), rows, note)


def _stages(contended: Profile | None, undisputed: Profile | None, idle: Profile | None) -> Table:
    profiles = (contended, undisputed, idle)
    stages = [each.stages if each else dict.fromkeys(STAGES, 0.0) for each in profiles]
    rows = []
    for stage in (*STAGES, "all"):
        spent = [sum(each.values()) if stage == "all" else each[stage] for each in stages]
        cells = [
            f"{1e3 * of / max(profile.samples.total, 1):.3f}" if profile else "-"
            for of, profile in zip(spent[:2], profiles, strict=False)
        ]
        rows.append((stage, *cells, f"{spent[2] / idle.seconds:.2%}" if idle else "-"))
    looks = ", ".join(str(each.looks) for each in profiles if each)
    note = f"As `sendworthy profile` tells it of the first robot, and of the idle operator; found in {looks} looks."
    columns = ("stage", "mixed [ms/sample]", "undisputed [ms/sample]", "idle [of a core]")
    return Table("Where the time of a daemon goes", columns, tuple(rows), note)
