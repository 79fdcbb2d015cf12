"""What it costs a daemon to be watched: `sendworthy top` and `why`, metrics that are scraped, recordings, logs as JSON.

Two teams fly the same traffic side by side and are watched by turns, while one is the other is not: what else the
machine does meets both alike, and what one team takes more than the other counts once for and once against.
"""

import logging
import math
import time
import timeit
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean, variance
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Self

from proxy.log import STAMPED, JsonLine, OneLine
from studies.benchmarks.budget import MEGABYTE, SMALL, UNDISPUTED
from studies.benchmarks.report import Table
from studies.benchmarks.resources import private_memory, processor_time, resident_memory
from studies.benchmarks.traffic.agenda import Agenda, draw
from studies.benchmarks.traffic.flight import start_applications
from studies.benchmarks.watchers import RECORD, SCRAPED_EVERY, SCRAPER, TOP, WHY
from studies.demo.layout import Node, lay_out_teams, pairs
from studies.demo.nodes import start_daemons
from studies.demo.ports import free_ports
from studies.demo.processes import Process, Troupe
from studies.simulation.traffic.workloads import Workload, mixed

SETTLING = 6.0
"""The first turn begins so long after the traffic: streams are known then [s]."""
SWITCH = 1.0
"""What teams take so long after others watch is left out: they connect, and recordings begin with a snapshot [s]."""
TURN = 10.0
"""How long a turn is measured [s]: a multiple of how often `top` asks, metrics are scraped and records written."""
LEAD = 0.5
"""The applications are told the start time this long ahead [s]."""
PATIENCE = 30.0
"""How long who watches may take to get ready [s]."""
LINES = 2000
"""So many lines are written to tell what one takes."""
MANY = 200
T_95 = (12.7, 4.3, 3.2, 2.8, 2.6, 2.4, 2.4, 2.3, 2.3, 2.2, 2.2)
"""How many standard errors a mean is uncertain by in 95 % of cases, with 1, 2, ... degrees of freedom (Student's t)."""


@dataclass(frozen=True, slots=True)
class Watch:
    """Who watches each robot of a team, by what `watchers.py` calls them."""

    name: str
    watchers: tuple[str, ...] = ()


NOBODY = Watch("nobody")
ALL = Watch("all of this together", (TOP, WHY, SCRAPER, RECORD))
WATCHES = (
    Watch("`sendworthy top`", (TOP,)),
    Watch("`sendworthy why --follow`", (WHY,)),
    Watch(f"metrics each {SCRAPED_EVERY:g} s", (SCRAPER,)),
    Watch("recording", (RECORD,)),
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
QUICK = CASES[1:2]
"""What a quick look flies."""


@dataclass(frozen=True, slots=True)
class Round:
    """What part of a core two teams took in two turns: first the one was watched, then the other."""

    first: tuple[float, float]
    second: tuple[float, float]

    @property
    def more(self) -> float:
        """The logarithm of how many times as much a team takes that is watched."""
        (watched, alone), (other_alone, other_watched) = self.first, self.second
        return 0.5 * math.log(watched * other_watched / (alone * other_alone))

    @property
    def alone(self) -> float:
        """What a team took in a turn in which nobody watched it."""
        return (self.first[1] + self.second[0]) / 2


@dataclass(frozen=True, slots=True)
class Flown:
    """What was found of a case: rounds by who watched.

    Each robot's daemon takes memory for all of it [B], that nobody shares and altogether, and writes so many `lines`
    [1/s] to its log.
    """

    robots: int
    rounds: dict[Watch, list[Round]]
    private: float
    resident: float
    lines: float

    @property
    def alone(self) -> float:
        """What a robot's daemon takes of a core when nobody watches it."""
        turns = [each.alone for those in self.rounds.values() for each in those]
        return fmean(turns) / self.robots


def measure_watching(*, quick: bool) -> list[Table]:
    """Fly all cases at once, for seven minutes; `quick` flies one, and tells of everything together only."""
    flown = fly(QUICK, (ALL, ALL), TURN / 4) if quick else fly(CASES, (ALL, *WATCHES) * 3)
    return tables(flown, json_line())


def fly(cases: Sequence[Case], plan: Sequence[Watch], seconds: float = TURN) -> dict[Case, Flown]:
    """Fly two teams of each case at once, with a round of each watch of the plan, its turns so long [s].

    Before these comes a round of `ALL`, in which all that is needed is loaded: of it memory is told, and not the time.
    Before that one team of each flies for as long with nothing of it on board.
    """
    two = 2 * (SWITCH + seconds)
    with started(cases, two, 1, watchable=False) as (teams, start):
        wait_until(start + SETTLING + two)
        bare = [team.memory() for (team,) in teams]
    rounds: list[dict[Watch, list[Round]]] = [{} for _ in cases]
    with started(cases, two * (1 + len(plan)), 2, watchable=True) as (teams, start):
        wait_until(start + SETTLING)
        fly_round(teams, ALL, seconds)
        full = [watched.memory() for _, watched in teams]
        for watch in plan:
            for found, flown in zip(rounds, fly_round(teams, watch, seconds), strict=True):
                found.setdefault(watch, []).append(flown)
        lines = [fmean(team.lines() for team in both) / (time.monotonic() - start) for both in teams]
    more = [(its[0] - without[0], its[1] - without[1]) for its, without in zip(full, bare, strict=True)]
    robots = [len(case.workload.robots) for case in cases]
    return {case: Flown(robots[at], rounds[at], *more[at], lines[at]) for at, case in enumerate(cases)}


@contextmanager
def started(
    cases: Sequence[Case], seconds: float, count: int, *, watchable: bool
) -> Iterator[tuple[list[list["Team"]], float]]:
    """Start so many teams of each case that fly the same; yield them, and when their traffic begins [s]."""
    with ExitStack() as stack, ThreadPoolExecutor(len(cases)) as beside:
        teams = list[list[Team]]()
        for case in cases:
            agenda = draw(case.workload, SETTLING + seconds, 0)
            layouts = lay_out_teams(len(agenda.robots), count)
            teams.append([stack.enter_context(Team(case, agenda, each, watchable=watchable)) for each in layouts])
        every = [team for each in teams for team in each]
        list(beside.map(Team.start, every))
        start = time.monotonic() + LEAD
        for team in every:
            team.tell(start)
        yield teams, start


def fly_round(teams: Sequence[Sequence["Team"]], watch: Watch, seconds: float) -> list[Round]:
    """Watch both teams for a turn each; return what they take in each case."""
    first, second = turn(teams, watch, 0, seconds), turn(teams, watch, 1, seconds)
    return [Round(one, other) for one, other in zip(first, second, strict=True)]


def turn(teams: Sequence[Sequence["Team"]], watch: Watch, watched: int, seconds: float) -> list[tuple[float, float]]:
    """Watch one team of two for a turn; return what part of a core both take in each case."""
    for both in teams:
        both[1 - watched].watch(NOBODY)
        both[watched].watch(watch)
    began = time.monotonic() + SWITCH
    wait_until(began)
    before = [[team.processor_time() for team in both] for both in teams]
    wait_until(began + seconds)
    after = [[team.processor_time() for team in both] for both in teams]
    taken = zip(before, after, strict=True)
    return [((now[0] - then[0]) / seconds, (now[1] - then[1]) / seconds) for then, now in taken]


class Team:
    """An operator, robots, their applications and who watches these robots: processes, while in a `with` statement.

    Where it is `watchable` daemons serve metrics and log JSON, and somebody is there who can watch them.
    """

    def __init__(self, case: Case, agenda: Agenda, nodes: tuple[Node, ...], *, watchable: bool) -> None:
        self._case = case
        self._agenda = agenda
        self._nodes = nodes
        self._stack = ExitStack()
        self._folder = Path(self._stack.enter_context(TemporaryDirectory(prefix="sendworthy-watching-")))
        self._troupe = self._stack.enter_context(Troupe(self._folder))
        self._addresses = [f"127.0.0.1:{port}" for port in free_ports(len(nodes) - 1)] if watchable else []
        self._robots: list[Process] = []
        self._publishers: list[Process] = []
        self._watchers: Process | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def start(self) -> None:
        """Start all processes; return when they are ready."""
        dials: dict[str, list[str]] = {node.name: [] for node in self._nodes}
        for dialer, target in pairs(self._nodes):
            dials[dialer.name].append(target.mesh_endpoint)
        robots, spec = self._nodes[1:], self._case.spec
        flags = {
            robot.name: ["--metrics.listen", address, "--log.format", "json"]
            for robot, address in zip(robots, self._addresses, strict=False)
        }
        _, *self._robots = start_daemons(self._troupe, self._nodes, dials, spec, self._folder, own_flags=flags)
        _, *self._publishers = start_applications(self._troupe, self._nodes, self._agenda, self._folder)
        if self._addresses:
            command = ["-m", "studies.benchmarks.watchers"]
            for place, (robot, address) in enumerate(zip(robots, self._addresses, strict=True)):
                key = self._agenda.of(place, robot.name)["keys"][0]
                command += ["--robot", f"{robot.app_endpoint}={key}={address}"]
            self._watchers = self._troupe.start("watchers", *command)
            self._watchers.hear(PATIENCE)

    def tell(self, start: float) -> None:
        """Have the applications publish from then on."""
        for publisher in self._publishers:
            publisher.tell(start)

    def watch(self, watch: Watch) -> None:
        """Have these and no others watch from now on."""
        if self._watchers is not None:
            self._watchers.tell(watch.watchers)

    def processor_time(self) -> float:
        """Return what the daemons of the robots have taken up to now [s]. Raises DemoError if any process ended."""
        self._troupe.check()
        return sum(processor_time(daemon.pid) for daemon in self._robots)

    def memory(self) -> tuple[float, float]:
        """Return what each robot's daemon has in the mean, that nobody shares and altogether [B]."""
        pids = [robot.pid for robot in self._robots]
        return fmean(map(private_memory, pids)), fmean(map(resident_memory, pids))

    def lines(self) -> float:
        """Return how many lines each robot's daemon has logged in the mean."""
        return fmean(len(daemon.errors()) for daemon in self._robots)


def wait_until(when: float) -> None:
    """Return at that time [s], or at once when it is past."""
    time.sleep(max(0.0, when - time.monotonic()))


def json_line() -> float:
    """Return by how much a line of the log takes longer as JSON than as text [s]."""
    record = logging.LogRecord("proxy.loop", logging.INFO, __file__, 1, "robot %s is here", ("r1",), None)
    as_json, as_text = (
        min(timeit.repeat(lambda each=each: each.format(record), number=LINES, repeat=5)) / LINES  # type: ignore[misc]
        for each in (JsonLine(), OneLine(STAMPED))
    )
    return as_json - as_text


def more(rounds: Mapping[Watch, Sequence[Round]]) -> dict[Watch, tuple[float, float]]:
    """Return what part more a watched daemon takes by who watched, and how uncertain that is (95 %).

    Rounds differ as much whoever watches: how much is told by all of them.
    """
    found = {watch: [each.more for each in those] for watch, those in rounds.items()}
    free = sum(len(each) - 1 for each in found.values())
    spread = sum(variance(each) * (len(each) - 1) for each in found.values() if len(each) > 1) / free
    times = T_95[min(free, len(T_95)) - 1]
    return {watch: (math.expm1(fmean(each)), times * (spread / len(each)) ** 0.5) for watch, each in found.items()}


def tables(flown: Mapping[Case, Flown], line: float) -> list[Table]:
    """Return what was found, a column for each case; a line of the log takes so much longer as JSON [s]."""
    columns = ("switched on", *(case.title for case in flown))
    found = [more(each.rounds) for each in flown.values()]
    rows = [(watch.name, *(f"{each[watch][0]:+.1%} ± {each[watch][1]:.1%}" for each in found)) for watch in found[0]]
    logs = [f"{each.lines * line / each.alone:+.3%}" for each in flown.values()]
    return [
        Table(
            "What more of the processor a daemon takes that is watched",
            columns,
            (*sorted(rows, key=lambda row: row[0] == ALL.name), ("logs as JSON", *logs)),
            "Processor time of the robots' daemons. Two teams that fly the same traffic are watched by turns of"
            f" {TURN:g} s (a quarter of that in a quick look), while one is the other is not; {SWITCH:g} s before each"
            " turn are left out, and a first round in which all that is needed is loaded. What watches"
            " takes besides in processes of its own is not counted. `top` and `why`, which asks about one stream, ask"
            " as often as by default. What `why` tells is kept in any case. Of logs it is measured what a line takes"
            f" longer as JSON than as text, {line * 1e6:.0f} us, and how many there are.",
        ),
        Table(
            "What else",
            ("", *columns[1:]),
            (
                (
                    "memory for all of it, that nobody shares [MB]",
                    *(f"{each.private / MEGABYTE:+.1f}" for each in flown.values()),
                ),
                ("resident [MB]", *(f"{each.resident / MEGABYTE:+.1f}" for each in flown.values())),
                ("part of a core that a daemon takes alone", *(f"{each.alone:.1%}" for each in flown.values())),
            ),
            "Memory beside that of a daemon that has nothing of it on board, after as long.",
        ),
    ]
