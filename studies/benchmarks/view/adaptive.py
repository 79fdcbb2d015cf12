"""Adaptive limits on a medium whose rate is halved and doubled, beside limits that are right from the start."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from statistics import median

from planner import Linear, Message, Problem, SearchSettings, Stream
from planner.definition import utility
from proxy.core.settings import CoreSettings
from proxy.core.transport import UNICAST, broadcast
from studies.simulation.conditions import Coordination, Transport
from studies.simulation.flights import GROUP
from studies.simulation.medium import Medium
from studies.simulation.missions import OPERATOR, specs_of
from studies.simulation.records import Frame
from studies.simulation.team import Team

RATE = 100_000.0
"""Of the medium before it is halved, and after it is doubled again [B/s]."""
PART = 0.9
"""A right limit is this part of the rate."""
SETTLED = 2.0
"""After this time the limit has to be right [s]."""
ASKED = 0.85
"""Of what constant limits reach."""
DELAY = 0.02
STARTED = 5.0
"""After this time a team knows what a constant medium bears [s]."""
CALM, LOOK = 0.5, 1.0
"""Without a queue samples are late by this at most in the middle of so long [s]; one takes 0.4 s at half the rate."""
SIZE, PACE, SLOPE = 20_000, 20.0, 0.5
"""Samples: bytes, Hz of all robots together, how fast they fade [1/s]."""
ARRANGEMENTS: tuple[tuple[Coordination, Transport], ...] = (("overhear", "broadcast"), ("shares", "unicast"))

ADAPTIVE = 'limit = "adaptive"\nceiling = "200 kB/s"'
SPEC = """
[[constraint]]
kind = "throughput"
{limit}
window = 1

[[information_type]]
name = "any"
keys = ["**"]
aggregation = "most_recent"
utility = {{ kind = "linear", slope = {slope} }}
"""

Row = tuple[str, str, str, str]


@dataclass(frozen=True, slots=True)
class Course:
    """Teams of so many robots; the medium is halved and doubled again at these times, and the flight ends [s]."""

    teams: tuple[int, ...] = (2, 5, 8)
    halved: float = 15.0
    doubled: float = 25.0
    end: float = 35.0

    def frames(self, robots: int) -> list[Frame]:
        """What apps publish; robots take turns."""
        count = int(self.end * PACE)
        return [Frame(f"r{i % robots}", f"r{i % robots}/data", i / PACE, SIZE, {}) for i in range(count)]

    def phases(self) -> tuple[tuple[str, float, float, float], ...]:
        """Name what happened, from when to when it has to be right, and the rate then."""
        return (
            ("constant", STARTED, self.halved, RATE),
            ("halved", self.halved + SETTLED, self.doubled, RATE / 2.0),
            ("doubled", self.doubled + SETTLED, self.end, RATE),
        )


QUICK = Course(teams=(2,), halved=8.0, doubled=13.0, end=18.0)


def adaptive_rows(course: Course) -> Iterator[Row]:
    """Yield a row for each arrangement, size of the team and change of the rate."""
    for coordination, transport in ARRANGEMENTS:
        for robots in course.teams:
            yield from _Flights(course, robots, coordination, transport).rows()


@dataclass
class _Flights:
    """One team that adapts, and one with the right limit for each rate, flown when they are asked for."""

    course: Course
    robots: int
    coordination: Coordination
    transport: Transport
    _right: dict[float, Team] = field(default_factory=dict)

    def rows(self) -> Iterator[Row]:
        """Yield a row for each phase."""
        changes = ((self.course.halved, RATE / 2.0), (self.course.doubled, RATE))
        team = self._fly(ADAPTIVE, Medium(RATE, DELAY, rates=changes))
        asked = f"after {SETTLED:g} s ≥ {100 * ASKED:g} % of a constant limit"
        for what, since, until, rate in self.course.phases():
            if rate not in self._right:
                self._right[rate] = self._fly(f'limit = "{PART * rate} B/s"', Medium(rate, DELAY))
            share = _worth(team, since, until) / _worth(self._right[rate], since, until)
            measured = [f"{100 * share:.1f} %", f"{100 * _used(team, since, until) / rate:.0f} % of the link"]
            measured.append(_delay(team, since, until))
            if what == "constant":
                measured.append(f"least robot {100 * _fairness(team, since, until, self.robots):.0f} % of the most")
            else:
                measured.append(_calm(team, since - SETTLED, until))
            name = f'Rate {what}, limit = "adaptive", {self.robots} robots: {self.coordination}, {self.transport}'
            yield name, asked, ", ".join(measured), "yes" if share >= ASKED else "no"

    def _fly(self, limit: str, medium: Medium) -> Team:
        team = _team(self.robots, self.coordination, self.transport, limit, medium)
        team.run(self.course.frames(self.robots), self.course.end)
        return team


def _used(team: Team, since: float, until: float) -> float:
    """Samples on the air [B/s]."""
    return sum(sent.size for sent in team.on_air if sent.frame and since <= sent.t < until) / (until - since)


def _late(team: Team, since: float, until: float) -> list[float]:
    """How long samples were on their way that were sent then [s]."""
    return [d.t_rcv - d.t_sent for d in team.deliveries if d.t_rcv is not None and since <= d.t_sent < until]


def _delay(team: Team, since: float, until: float) -> str:
    late = _late(team, since, until)
    return f"delay {1000 * median(late):.0f} ms" if late else "nothing sent"


def _calm(team: Team, since: float, until: float) -> str:
    """Say after what time samples are not late for two seconds, in the middle; none sent is no calm."""
    spans = [since + LOOK * i for i in range(int((until - since) / LOOK))]
    calm = [median(_late(team, t, t + LOOK) or [2.0 * CALM]) <= CALM for t in spans]
    for i, t in enumerate(spans):
        if all(calm[i : i + 2]):
            return f"calm after {t - since:.1f} s"
    return "never calm"


def _fairness(team: Team, since: float, until: float, robots: int) -> float:
    """What the robot that sent least sent of what the one that sent most did."""
    sent = Counter(each.robot for each in team.on_air if each.frame and since <= each.t < until)
    return min(sent[f"r{i}"] for i in range(robots)) / max(sent.values(), default=1)


def _team(robots: int, coordination: Coordination, transport: Transport, limit: str, medium: Medium) -> Team:
    """Return a team under this limit."""
    nothing: tuple[str, ...] = ()
    interests = dict.fromkeys([f"r{i}" for i in range(robots)], nothing) | {OPERATOR: ("*/data",)}
    how = UNICAST if transport == "unicast" else broadcast(GROUP)
    return Team(
        specs_of(SPEC.format(limit=limit, slope=SLOPE)),
        interests,
        medium,
        settings=CoreSettings(
            "", "", coordination=coordination, transport=how, digests_on_air=transport == "broadcast"
        ),
        search=SearchSettings(search="best"),
        iterations=100,
    )


def _worth(team: Team, since: float, until: float) -> float:
    """What the operator got in this time [utility·s]."""
    arrived = [(d.t_rcv, d) for d in team.deliveries if d.t_rcv is not None and d.t_rcv < until]
    received = sorted(arrived, key=lambda entry: (entry[0], entry[1].frame.t_gen))
    robots = sorted({d.frame.robot for _, d in received})
    fading = Linear(1.0, SLOPE)
    messages = tuple(
        Message(robots.index(d.frame.robot), d.frame.t_gen, d.t_sent, max(t_rcv, since), fading, 1.0, ())
        for t_rcv, d in received
    )
    streams = tuple(Stream(number) for number in range(len(robots)))
    problem = Problem(streams, messages, 0, (), (), t_start=since, t_end=until)
    return max(utility(problem, range(len(messages))), 1e-9)
