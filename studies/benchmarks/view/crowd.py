"""What one core costs in a crowd: time of a view update and of a decision, and memory."""

import tracemalloc
from dataclasses import dataclass
from statistics import median
from time import perf_counter

from planner import SearchSettings, start
from proxy.core import events as ev
from proxy.core.commands import Decide, Forward
from proxy.core.core import Core
from proxy.core.settings import CoreSettings
from proxy.core.transport import broadcast
from proxy.core.wire import Digest, State, StreamDigest, StreamState, tag
from studies.benchmarks.memory import MEGABYTE
from studies.benchmarks.report import Table
from studies.simulation.missions import specs_of

STREAMS = 5
"""Of each robot, at 1 Hz."""
ROUNDS = 20
"""Digests heard of every robot before anything is measured, a second apart."""
SIZE = 2_048
SPEC = """
[[constraint]]
kind = "throughput"
limit = "100 kB/s"
window = 0.5

[[information_type]]
name = "any"
keys = ["**"]
aggregation = "most_recent"
utility = { kind = "linear", slope = 0.5 }
"""
TRANSPORT = broadcast("224.0.0.226:7449")
KINDS = ("sample heard [µs]", "digest heard [µs]", "time passed [µs]", "problem [ms]", "search [ms]", "memory [MB]")


@dataclass(frozen=True, slots=True)
class Cost:
    """Medians of what a core takes to hear a sample, a digest of all streams, and that time passed [s].

    Then to take in an own sample and build its problem, and to search that [s]; and its memory [B].
    """

    sample: float
    digest: float
    passed: float
    problem: float
    search: float
    memory: float

    def cells(self) -> tuple[str, ...]:
        """Return a cell for each of KINDS."""
        micro = (f"{1e6 * seconds:.0f}" for seconds in (self.sample, self.digest, self.passed))
        milli = (f"{1e3 * seconds:.2f}" for seconds in (self.problem, self.search))
        return *micro, *milli, f"{self.memory / MEGABYTE:.1f}"


class Crowd:
    """The core of one robot of many, who all want everything and broadcast one in five samples of each stream."""

    def __init__(self, robots: int) -> None:
        self.robots = [f"robot{i}" for i in range(robots)]
        settings = CoreSettings("robot0", _zid("robot0"), coordination="overhear", transport=TRANSPORT)
        self.now = 1000.0
        self.core = Core(settings, specs_of(SPEC), self.now)
        self.core.handle(ev.InterestChanged(self.now, ("**",)))
        for robot in self.robots[1:]:
            self.core.handle(ev.PeerAppeared(self.now, robot, _zid(robot)))
            self.core.handle(ev.StateHeard(self.now, _state(robot)))
        self._numbers = 0
        self._rounds = 0
        for _ in range(ROUNDS):
            self.round()

    def round(self) -> list[float]:
        """Let a second pass in which everybody tells its news; return what each digest took [s]."""
        self.now, self._rounds = self.now + 1.0, self._rounds + 1
        return [self._time(self._digest(robot, i)) for i, robot in enumerate(self.robots[1:])]

    def hear(self) -> list[float]:
        """Hear a sample of each stream; return what each took [s]."""
        return [
            self._time(ev.SampleHeard(self.now, f"{robot}/{stream}", SIZE, _zid(robot), self.now, None))
            for robot in self.robots[1:]
            for stream in range(STREAMS)
        ]

    def pass_time(self, times: int) -> list[float]:
        """Let time pass so often; return what each took [s]."""
        return [self._time(ev.TimePassed(self.now)) for _ in range(times)]

    def decide(self) -> tuple[float, float]:
        """Publish a sample, and decide it; return what building the problem and searching it took [s]."""
        self._numbers += 1
        self.now += 1.0
        event = ev.SamplePublished(self.now, self._numbers, "robot0/0", SIZE, self.now, None, 5, {})
        begin = perf_counter()
        decide = next((c for c in self.core.handle(event) if isinstance(c, Decide)), None)
        built = perf_counter() - begin
        if decide is None:
            raise RuntimeError("the core had nothing to decide: its limits are too tight for the benchmark")
        begin = perf_counter()
        search = start(decide.problem, SearchSettings(search="best"), decide.seed)
        search.run(decide.iterations)
        plan = search.plan()
        searched = perf_counter() - begin
        for command in self.core.handle(ev.DecisionReady(self.now, decide.ticket, plan)):
            if isinstance(command, Forward):
                self.core.handle(ev.SampleHanded(self.now, command.sample))
        return built, searched

    def _time(self, event: ev.Event) -> float:
        begin = perf_counter()
        self.core.handle(event)
        return perf_counter() - begin

    def _digest(self, robot: str, number: int) -> ev.DigestHeard:
        sent = self.now - 0.02
        streams = tuple(
            StreamDigest(
                i, self._rounds, self._rounds // 5, at, at - self._rounds % 5 if self._rounds >= 5 else 0.0, SIZE, 1.0
            )
            for i in range(STREAMS)
            for at in (sent - (0.17 * number + 0.2 * i) % 1.0,)
        )
        return ev.DigestHeard(self.now, Digest(robot, tag(_zid(robot)), sent, 0, 0, 0, streams))


def measure_crowd(*, quick: bool) -> Table:
    """Measure a team of ten and a crowd of a hundred side by side; `quick`: of three and six."""
    sizes = (3, 6) if quick else (10, 100)
    costs = [_cost(robots, 3 if quick else 20) for robots in sizes]
    rows = [(f"{robots} robots", *cost.cells()) for robots, cost in zip(sizes, costs, strict=True)]
    return Table(
        f"One core in a crowd, {STREAMS} streams of each robot",
        ("team", *KINDS),
        tuple(rows),
        "Medians. A sample of another robot, and a digest with news of all its streams, until the core has nothing more"
        " to do; an own sample until its problem is there, horizon 60; its search, best mode, 300 iterations, tables"
        " included; what the core holds in memory. Coordination overhear, broadcast.",
    )


def _cost(robots: int, times: int) -> Cost:
    tracemalloc.start()
    held = Crowd(robots)
    memory, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del held
    crowd = Crowd(robots)
    digests = [took for _ in range(times) for took in crowd.round()]
    samples = [took for _ in range(times) for took in crowd.hear()]
    passed = crowd.pass_time(10 * times)
    decided = [crowd.decide() for _ in range(times)]
    return Cost(
        sample=median(samples),
        digest=median(digests),
        passed=median(passed),
        problem=median(built for built, _ in decided),
        search=median(searched for _, searched in decided),
        memory=memory,
    )


def _zid(robot: str) -> str:
    number = int(robot.removeprefix("robot"))
    return f"{number:08x}"


def _state(robot: str) -> State:
    streams = tuple(StreamState(i, f"{robot}/{i}", "any", 1.0) for i in range(STREAMS))
    return State(robot, _zid(robot), "enforce", "", streams, ("**",), 0.0, (), TRANSPORT)
