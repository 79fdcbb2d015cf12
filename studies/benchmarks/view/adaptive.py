"""Adaptive limits on a medium whose rate is halved and doubled, beside limits that are right from the start."""

from collections.abc import Iterator
from dataclasses import dataclass
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
from utility_specs.errors import SpecsError

RATE = 100_000.0
"""Of the medium before it is halved, and after it is doubled again [B/s]."""
PART = 0.9
"""A right limit is this part of the rate."""
SETTLED = 2.0
"""After this time the limit has to be right [s]."""
ASKED = 0.85
"""Of what constant limits reach."""
DELAY = 0.02
SIZE, PACE, SLOPE = 20_000, 5.0, 0.5
"""Samples of all robots: bytes, Hz, how fast they fade [1/s]."""
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
    """So many robots; the medium is halved and doubled again at these times, and the flight ends [s]."""

    robots: int = 4
    halved: float = 20.0
    doubled: float = 35.0
    end: float = 50.0

    def frames(self) -> list[Frame]:
        """What apps publish; robots take turns."""
        count = int(self.end * PACE)
        return [
            Frame(f"r{robot}", f"r{robot}/data", (i + robot / self.robots) / PACE, SIZE, {})
            for i in range(count)
            for robot in range(self.robots)
        ]

    def phases(self) -> tuple[tuple[str, float, float, float], ...]:
        """Name what happened, from when to when it has to be right, and the rate then."""
        return (
            ("halved", self.halved + SETTLED, self.doubled, RATE / 2.0),
            ("doubled", self.doubled + SETTLED, self.end, RATE),
        )


QUICK = Course(robots=2, halved=4.0, doubled=8.0, end=12.0)


def adaptive_rows(course: Course) -> Iterator[Row]:
    """Yield a row for each arrangement and change of the rate."""
    changes = ((course.halved, RATE / 2.0), (course.doubled, RATE))
    for coordination, transport in ARRANGEMENTS:
        for what, since, until, rate in course.phases():
            name = f'Rate {what}, limit = "adaptive": {coordination}, {transport}'
            asked = f"after {SETTLED:g} s ≥ {100 * ASKED:g} % of a constant limit"
            try:
                team = _team(course, coordination, transport, ADAPTIVE, Medium(RATE, DELAY, rates=changes))
            except SpecsError:
                yield name, asked, "this version has no adaptive limits", "not measured"
                continue
            right = _team(course, coordination, transport, f'limit = "{PART * rate} B/s"', Medium(rate, DELAY))
            measured, share = _beside(team, right, course, since, until)
            yield name, asked, measured, "yes" if share >= ASKED else "no"


def _beside(team: Team, right: Team, course: Course, since: float, until: float) -> tuple[str, float]:
    """Fly both; say what the first reaches beside the other between these times, and the share."""
    for each in (team, right):
        each.run(course.frames(), course.end)
    share = _worth(team, since, until) / _worth(right, since, until)
    late = [d.t_rcv - d.t_sent for d in team.deliveries if d.t_rcv is not None and since <= d.t_sent < until]
    delay = f"delay {1000 * median(late):.0f} ms" if late else "nothing sent"
    return f"{100 * share:.1f} %, {delay}", share


def _team(course: Course, coordination: Coordination, transport: Transport, limit: str, medium: Medium) -> Team:
    """Return a team under this limit; raise `SpecsError` when this version has no such limit."""
    nothing: tuple[str, ...] = ()
    interests = dict.fromkeys([f"r{i}" for i in range(course.robots)], nothing) | {OPERATOR: ("*/data",)}
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
