"""What one core costs in a crowd: time of a view update and of a decision, and memory."""

import tracemalloc
from collections import defaultdict
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from statistics import median
from time import thread_time

from planner import Plan, SearchSettings, start
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Decide, Forward
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState, tag
from studies.benchmarks.memory import MEGABYTE
from studies.benchmarks.report import Table
from studies.simulation.conditions import Coordination
from studies.simulation.missions import specs_of

STREAMS = 5
"""Of each robot, at 1 Hz."""
ROUNDS = 12
"""Seconds that everybody publishes before anything is measured: then all schedules are known well."""
SIZE = 2_048
EACH = 8
"""The limit for each robot [kB/s]."""
SPEC = """
[[constraint]]
kind = "throughput"
limit = "%d kB/s"
window = 0.5

[[information_type]]
name = "any"
keys = ["**"]
aggregation = "most_recent"
utility = { kind = "linear", slope = 0.5 }
"""
TRANSPORTS = {"announce": broadcast("224.0.0.226:7449"), "split": UNICAST}
KINDS = (
    "own sample [µs]",
    "sample heard [µs]",
    "of it the view [µs]",
    "digest heard [µs]",
    "of it the view [µs]",
    "time passed [µs]",
    "problem [ms]",
    "search [ms]",
    "memory [MB]",
)
OWN, HEARD, TOLD, PASSED, PROBLEM, SEARCH, NOTED, LEARNED = range(8)
ECHOING = 4
"""Of so many digests one has an echo; every other echo is of a digest of ours."""
LATENCY = 0.02
"""What everything takes on its way [s]."""
JITTER = 5
"""What robots tell of the jitter of their streams, in parts of the period as digests have them."""
LOOP = 100_000
"""Rounds of the loop that tells how fast the machine is at the moment."""


@dataclass(frozen=True, slots=True)
class Cost:
    """What a core takes, in processor time [s], and its memory [B].

    Medians: to take in a sample of its own while another one is decided, a sample heard, a digest of one stream, and
    that time passed, each until it is known when to wake up, and what the shared view takes of that; to build a
    problem, with what leads to it, and to search that; None of what always leads to a problem, or of problems where
    nothing is contested.
    """

    own: float | None
    sample: float | None
    noted: float
    digest: float | None
    learned: float
    passed: float | None
    problem: float | None
    search: float | None
    memory: float

    def cells(self) -> tuple[str, ...]:
        """Return a cell for each of KINDS."""
        events = (self.own, self.sample, self.noted, self.digest, self.learned, self.passed)
        micro = ("with the problem" if seconds is None else f"{1e6 * seconds:.0f}" for seconds in events)
        milli = ("none" if seconds is None else f"{1e3 * seconds:.2f}" for seconds in (self.problem, self.search))
        return *micro, *milli, f"{self.memory / MEGABYTE:.1f}"


class Crowd:
    """The core of one robot of many; in `split` each has its part. All want everything, and send every other sample."""

    def __init__(self, robots: int, coordination: Coordination) -> None:
        self.robots = [f"robot{i}" for i in range(robots)]
        self.transport = TRANSPORTS[coordination]
        settings = CoreSettings("robot0", _zid("robot0"), coordination=coordination, transport=self.transport)
        self.now = 1000.0
        self.core = Core(settings, specs_of(SPEC % (EACH * robots)), self.now)
        self.core.handle(ev.InterestChanged(self.now, ("**",)))
        for robot in self.robots[1:]:
            self.core.handle(ev.PeerAppeared(self.now, robot, _zid(robot)))
            self.core.handle(ev.StateHeard(self.now, self._state(robot)))
        self.took: dict[int, list[float]] = defaultdict(list)
        """Processor times by what they were taken for [s]."""
        self._numbers = 0
        self._digests = 0
        self._rounds = 0
        for _ in range(ROUNDS):
            self.round()
        self.took.clear()

    def round(self) -> None:
        """Let a second pass in which all publish a sample of each stream, one after the other."""
        self._rounds += 1
        begin, turns = self.now, [(stream, robot) for stream in range(STREAMS) for robot in self.robots]
        for place, (stream, robot) in enumerate(turns):
            self.now = begin + place / len(turns)
            if robot == "robot0":
                self._publish(*range(stream, min(stream + 2, STREAMS)) if stream % 2 == 0 else ())
                continue
            if (self._rounds + stream) % 2:
                key = f"{robot}/{stream}"
                self._handle(HEARD, ev.SampleHeard(self.now, key, SIZE, _zid(robot), self.now - LATENCY, None))
            self._handle(TOLD, self._digest(robot, stream))
            self._handle(PASSED, ev.TimePassed(self.now))
        self.now = begin + 1.0

    def time_view(self) -> None:
        """From now on measure what the view takes of each event."""
        view = self.core.view
        self._timed(NOTED, view.overhearing, "take")
        self._timed(LEARNED, view, "heard_digest")
        self.core = copy(self.core)  # which asks its parts anew what takes events in

    def _timed(self, kind: int, part: object, name: str) -> None:
        update: Callable[..., object] = getattr(part, name)

        def timed(*of: object) -> object:
            begin = thread_time()
            found = update(*of)
            self.took[kind].append(thread_time() - begin)
            return found

        setattr(part, name, timed)

    def _publish(self, *streams: int) -> None:
        """Publish a sample of each stream at once: the second one waits while the first is decided."""
        taken_in = [self._take_in(OWN, self._sample(stream)) for stream in streams]
        for commands in taken_in:
            self._carry_out(commands)

    def _sample(self, stream: int) -> ev.SamplePublished:
        self._numbers += 1
        return ev.SamplePublished(self.now, self._numbers, f"robot0/{stream}", SIZE, self.now, None, 5, {})

    def _handle(self, kind: int, event: ev.Event, *, other: bool = False) -> None:
        """Take in an event, and decide what there is to decide."""
        self._carry_out(self._take_in(kind, event, other=other))

    def _take_in(self, kind: int, event: ev.Event, *, other: bool = False) -> list[Command]:
        """Take in an event and measure that; what is `other` only where it leads to a problem."""
        begin = thread_time()
        commands = self.core.handle(event)
        self.core.wake_at(self.now)
        took = thread_time() - begin
        decides = [command for command in commands if isinstance(command, Decide)]
        if decides or not other:
            self.took[PROBLEM if decides else kind].append(took)
        return commands

    def _carry_out(self, commands: list[Command]) -> None:
        for command in commands:
            if isinstance(command, Decide):
                answer = ev.DecisionReady(self.now, command.ticket, self._search(command))
                self._handle(PASSED, answer, other=True)
            elif isinstance(command, Forward):
                self.core.handle(ev.SampleHanded(self.now, command.sample))

    def _search(self, decide: Decide) -> Plan:
        begin = thread_time()
        search = start(decide.problem, SearchSettings(search="best"), decide.seed)
        search.run(decide.iterations)
        plan = search.plan()
        self.took[SEARCH].append(thread_time() - begin)
        return plan

    def _digest(self, robot: str, stream: int) -> ev.DigestHeard:
        sent, count = self.now - LATENCY, self._rounds
        forwarded = (count + stream % 2) // 2
        last = sent - 0.001 - (count + stream + 1) % 2
        news = StreamDigest(
            stream, count, forwarded, sent - 0.001, last if forwarded else 0.0, SIZE, 1.0, (), 1.0, 0, JITTER
        )
        name, echoes = tag(_zid(robot)), self._echoes(robot)
        return ev.DigestHeard(self.now, Digest(robot, name, sent, 0, 0, (news,), echoes=echoes, state=1))

    def _echoes(self, robot: str) -> tuple[Echo, ...]:
        """Now and then a robot tells what it got of another one, of each in its turn."""
        self._digests += 1
        turn, rest = divmod(self._digests, ECHOING)
        others = [name for name in self.robots if name != robot]
        if rest:
            return ()
        echoed = others[(7 * turn + turn // len(others)) % len(others)] if turn % 2 else self.robots[0]
        sent = self.now - 0.5
        return (Echo(tag(_zid(echoed)), sent, sent + LATENCY, 0, LATENCY),)

    def _state(self, robot: str) -> State:
        streams = tuple(StreamState(i, f"{robot}/{i}", "any", 1.0) for i in range(STREAMS))
        specs = self.core.view.specs.generation
        return State(robot, _zid(robot), "enforce", specs, streams, ("**",), transport=self.transport, number=1)


def measure_crowd(*, quick: bool) -> Table:
    """Measure a team of ten and a crowd of a hundred side by side; `quick`: of four and five."""
    coordinations: tuple[Coordination, ...] = ("announce", "split")
    rows = [
        (f"{robots} robots, {coordination}", *_cost(robots, coordination, 1 if quick else 3).cells())
        for coordination in coordinations
        for robots in ((4, 5) if quick else (10, 100))
    ]
    return Table(
        f"One core in a crowd, {STREAMS} streams of each robot",
        ("team", *KINDS),
        tuple(rows),
        "Medians of processor time: a sample of its own while another one is decided, a sample of another robot, a"
        " digest with news of one stream, and that time passed, each until the core has nothing more to do and it is"
        " known when to wake it, and what of it the shared view takes; an event until a problem is there, horizon 60;"
        " its search, best mode, 300 iterations, tables included. What the core holds in memory. Announce in"
        " broadcast, split in unicast. Digests tell period, phase and jitter,"
        " and echo, as those of daemons do."
        f" {LOOP:,} rounds of a loop that adds squares took {1e3 * _loop():.1f} ms.",
    )


def _cost(robots: int, coordination: Coordination, rounds: int) -> Cost:
    tracemalloc.start()
    held = Crowd(robots, coordination)
    memory, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del held
    crowd = Crowd(robots, coordination)
    for _ in range(rounds):
        crowd.round()
    took = dict(crowd.took)
    crowd.time_view()
    crowd.round()
    return Cost(
        own=_median(took.get(OWN, [])),
        sample=_median(took.get(HEARD, [])),
        noted=median(crowd.took[NOTED]),
        digest=_median(took.get(TOLD, [])),
        learned=median(crowd.took[LEARNED]),
        passed=_median(took.get(PASSED, [])),
        problem=_median(took.get(PROBLEM, [])),
        search=_median(took.get(SEARCH, [])),
        memory=memory,
    )


def _median(times: Sequence[float]) -> float | None:
    return median(times) if times else None


def _loop() -> float:
    """How long the machine takes for something that never changes [s]: the least of a few times."""
    return min(_squares() for _ in range(5))


def _squares() -> float:
    begin, total = thread_time(), 0
    for i in range(LOOP):
        total += i * i
    return thread_time() - begin


def _zid(robot: str) -> str:
    number = int(robot.removeprefix("robot"))
    return f"{number:08x}"
