"""What it costs a daemon to be watched: `sendworthy top` and `why`, metrics that are scraped, recordings, logs as JSON.

Two teams fly the same traffic side by side, one of them watched, so that whatever else the machine does meets both.
"""

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean, stdev
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Self

from studies.benchmarks.budget import MEGABYTE, SMALL, UNDISPUTED
from studies.benchmarks.report import Table
from studies.benchmarks.resources import private_memory, processor_time, resident_memory
from studies.benchmarks.traffic.agenda import Agenda, draw
from studies.benchmarks.traffic.flight import start_applications
from studies.demo.layout import Node, lay_out_teams, pairs
from studies.demo.nodes import start_daemons
from studies.demo.ports import free_ports
from studies.demo.processes import Process, Troupe
from studies.simulation.traffic.workloads import Workload, mixed

SLICE = 2.0
"""The processor time of both teams is read this often [s]."""
SETTLING = 4.0
"""What is read begins so long after the traffic: streams are known then, and recordings have begun [s]."""
LEAD = 0.5
"""The applications are told the start time this long ahead [s]."""
MANY = 200
T_95 = {2: 12.7, 3: 4.3, 4: 3.2, 5: 2.8, 6: 2.6, 7: 2.4, 8: 2.4, 9: 2.3, 10: 2.3}
"""How many standard errors the mean of so few is uncertain by, in 95 % of cases (Student's t); of more it is 2.1."""


@dataclass(frozen=True, slots=True)
class Watch:
    """Who watches each robot of a team: `top` at its interval, a scraper every so often [s], a recording, and JSON.

    `why`: somebody follows what is decided on its first stream.
    """

    name: str
    top: bool = False
    why: bool = False
    scraped: float = 0.0
    recorded: bool = False
    json: bool = False

    def flags(self, address: str) -> list[str]:
        """Return the flags of a daemon whose metrics, if any, are served there."""
        flags = ["--metrics.listen", address] if self.scraped else []
        flags += ["--record.on", "true"] if self.recorded else []
        return [*flags, *(["--log.format", "json"] if self.json else [])]


NOBODY = Watch("nobody")
ALL = Watch("all of it, metrics each 5 s", top=True, why=True, scraped=5.0, recorded=True, json=True)
WATCHES = (
    Watch("`sendworthy top`", top=True),
    Watch("`sendworthy why --follow`", why=True),
    Watch("metrics each 5 s", scraped=5.0),
    Watch("metrics each second", scraped=1.0),
    Watch("recording", recorded=True),
    Watch("logs as JSON", json=True),
    ALL,
)


@dataclass(frozen=True, slots=True)
class Case:
    """Traffic, and what an operator would write of it."""

    title: str
    workload: Workload
    spec: str


STREAMS = Workload(
    "streams",
    (tuple(replace(SMALL, name=f"odometry{number}", rates=(1.0, 1.0)) for number in range(MANY)),),
    UNDISPUTED.rate,
    UNDISPUTED.window,
)
CASES = (
    Case("mixed, 2 robots, 1 Mbit/s", mixed(2), mixed(2).spec()),
    Case("200 small ones a second", UNDISPUTED, UNDISPUTED.spec()),
    Case(f"the same of {MANY} streams", STREAMS, UNDISPUTED.spec().replace(f'"*/{SMALL.name}"', '"*/*"')),
)


@dataclass(frozen=True, slots=True)
class Pair:
    """What the robots' daemons of two teams took in each slice [s], and what memory each robot's has more [B]."""

    watched: tuple[float, ...]
    alone: tuple[float, ...]
    private: float
    resident: float


def measure_watching(*, quick: bool) -> list[Table]:
    """Fly all pairs; `quick` takes a minute, and tells of everything together only."""
    watches, slices, rounds = ((ALL,), 3, 1) if quick else (WATCHES, 5, 2)
    return tables({(case, watch): pairs_of(case, watch, slices, rounds) for case in CASES for watch in watches})


def pairs_of(case: Case, watch: Watch, slices: int, rounds: int) -> list[Pair]:
    """Fly some rounds; the watched team starts first in every other one."""
    return [fly_pair(case, watch, slices, seed, first=seed % 2 == 0) for seed in range(rounds)]


def fly_pair(case: Case, watch: Watch, slices: int, seed: int, *, first: bool = True) -> Pair:
    """Fly a team that is watched and one that is not, the watched one started `first`, for so many slices."""
    agenda = draw(case.workload, SETTLING + slices * SLICE, seed)
    order = (watch, NOBODY) if first else (NOBODY, watch)
    layouts = lay_out_teams(len(agenda.robots), len(order))
    with ExitStack() as stack, ThreadPoolExecutor(len(order)) as beside:
        teams = [stack.enter_context(Team(nodes, each)) for nodes, each in zip(layouts, order, strict=True)]
        list(beside.map(lambda team: team.start(case, agenda), teams))
        start = time.monotonic() + LEAD
        for team in teams:
            team.tell(start)
        taken = list(_slices(teams, start + SETTLING, slices))
        memory = [team.memory() for team in teams]
    at = order.index(watch)
    (private, resident), (its_private, its_resident) = memory[at], memory[1 - at]
    watched, alone = (tuple(each[of] for each in taken) for of in (at, 1 - at))
    return Pair(watched, alone, private - its_private, resident - its_resident)


class Team:
    """An operator, robots, their applications and who watches these robots: processes, while in a `with` statement."""

    def __init__(self, nodes: tuple[Node, ...], watch: Watch) -> None:
        self._nodes = nodes
        self._watch = watch
        self._stack = ExitStack()
        self._folder = Path(self._stack.enter_context(TemporaryDirectory(prefix="sendworthy-watching-")))
        self._troupe = self._stack.enter_context(Troupe(self._folder))
        self._addresses = [f"127.0.0.1:{port}" for port in free_ports(len(nodes) - 1)] if watch.scraped else []
        self._robots: list[Process] = []
        self._publishers: list[Process] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def start(self, case: Case, agenda: Agenda) -> None:
        """Start all processes; return when they are ready."""
        dials: dict[str, list[str]] = {node.name: [] for node in self._nodes}
        for dialer, target in pairs(self._nodes):
            dials[dialer.name].append(target.mesh_endpoint)
        robots = self._nodes[1:]
        addresses = self._addresses or [""] * len(robots)
        flags = {robot.name: self._watch.flags(at) for robot, at in zip(robots, addresses, strict=True)}
        _, *self._robots = start_daemons(self._troupe, self._nodes, dials, case.spec, self._folder, own_flags=flags)
        _, *self._publishers = start_applications(self._troupe, self._nodes, agenda, self._folder)
        command = ["-m", "studies.benchmarks.watchers", "--every", str(self._watch.scraped)]
        asked = ["--top", *(robot.app_endpoint for robot in robots)] if self._watch.top else []
        first = [agenda.of(place, robot.name)["keys"][0] for place, robot in enumerate(robots)]
        followed = [f"{robot.app_endpoint}={key}" for robot, key in zip(robots, first, strict=True)]
        why = ["--why", *followed] if self._watch.why else []
        scraped = ["--scrape", *self._addresses] if self._addresses else []
        if asked or why or scraped:
            self._troupe.start("watchers", *command, *asked, *why, *scraped)

    def tell(self, start: float) -> None:
        """Have the applications publish from then on."""
        for publisher in self._publishers:
            publisher.tell(start)

    def processor_time(self) -> float:
        """Return what the daemons of the robots have taken up to now [s]. Raises DemoError if any process ended."""
        self._troupe.check()
        return sum(processor_time(daemon.pid) for daemon in self._robots)

    def memory(self) -> tuple[float, float]:
        """Return what each robot's daemon has in the mean, that nobody shares and altogether [B]."""
        pids = [robot.pid for robot in self._robots]
        return fmean(map(private_memory, pids)), fmean(map(resident_memory, pids))


def _slices(teams: Sequence[Team], start: float, count: int) -> Iterator[list[float]]:
    """Yield what each team takes in each slice [s]."""
    time.sleep(max(0.0, start - time.monotonic()))
    before = [team.processor_time() for team in teams]
    for number in range(1, count + 1):
        time.sleep(max(0.0, start + number * SLICE - time.monotonic()))
        now = [team.processor_time() for team in teams]
        yield [last - first for first, last in zip(before, now, strict=True)]
        before = now


def more(flown: Sequence[Pair]) -> tuple[float, float]:
    """Return what part more processor time watched daemons take, and how uncertain that is (95 %)."""
    differences = [on - off for pair in flown for on, off in zip(pair.watched, pair.alone, strict=True)]
    mean = fmean(off for pair in flown for off in pair.alone)
    half = T_95.get(len(differences), 2.1) * stdev(differences) / len(differences) ** 0.5
    return fmean(differences) / mean, half / mean


def tables(flown: dict[tuple[Case, Watch], list[Pair]]) -> list[Table]:
    """Return what was found, a column for each case."""
    cases = tuple(dict.fromkeys(case for case, _ in flown))
    watches = tuple(dict.fromkeys(watch for _, watch in flown))
    columns = ("switched on", *(case.title for case in cases))
    time_note = (
        "Processor time of the robots' daemons beside that of the same daemons with nothing of it, who fly the same"
        f" traffic at the same time; read each {SLICE:g} s. What watches takes besides in processes of its own is not"
        " counted. `top` asks as often as by default, `why` about one stream. What it tells is kept in any case."
    )
    memory_note = "Of a robot's daemon at the end of the flight: that nobody shares / resident."
    return [
        Table(
            "What more of the processor a daemon takes that is watched",
            columns,
            tuple((watch.name, *(_time(flown[case, watch]) for case in cases)) for watch in watches),
            time_note,
        ),
        Table(
            "What more memory it takes [MB]",
            columns,
            tuple((watch.name, *(_memory(flown[case, watch]) for case in cases)) for watch in watches),
            memory_note,
        ),
    ]


def _time(flown: Sequence[Pair]) -> str:
    mean, half = more(flown)
    return f"{mean:+.1%} ± {half:.1%}"


def _memory(flown: Sequence[Pair]) -> str:
    private, resident = (fmean(getattr(pair, name) for pair in flown) for name in ("private", "resident"))
    return f"{private / MEGABYTE:+.1f} / {resident / MEGABYTE:+.1f}"
