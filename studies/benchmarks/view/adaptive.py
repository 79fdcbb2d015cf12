"""Adaptive limits on a medium whose rate is halved and doubled, beside limits that are right from the start.

Samples are small enough that a window of the right limit has room for several at half of the rate, too: of larger ones
whole numbers use so little of it, and robots wait so long for a turn, that the right limit itself is no yardstick.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from random import Random
from statistics import fmean, median

from planner import Linear, Message, Problem, SearchSettings, Stream
from planner.definition import utility
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
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
"""Of the utility that constant limits reach, and of the link that they use."""
DELAY = 0.02
STARTED = 5.0
"""After this time a team knows what a constant medium bears [s]."""
CALM, LOOK = 0.5, 1.0
"""Without a queue samples are late by this at most in the middle of so long [s]; one takes 0.2 s at half the rate."""
SIZE, PACE, SLOPE = 10_000, 40.0, 0.5
"""Samples: bytes, Hz of all robots together, how fast they fade [1/s]."""
OFF = 0.02
"""They come by up to this part of their period earlier or later than they should."""
JITTER, LOSS = 0.001, 0.01
"""Of the medium: mean [s] and part."""
ARRANGEMENTS: tuple[tuple[Coordination, Transport], ...] = (("announce", "broadcast"), ("announce", "unicast"))

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
    seeds: tuple[int, ...] = (1, 2, 3, 4)
    halved: float = 15.0
    doubled: float = 25.0
    end: float = 35.0

    def frames(self, robots: int, seed: int) -> list[Frame]:
        """What apps publish: all as often, each beginning at random."""
        draw, period = Random(seed), robots / PACE
        frames = []
        for robot in range(robots):
            begin = (OFF + draw.random()) * period
            times = (begin + (i + draw.uniform(-OFF, OFF)) * period for i in range(int(self.end / period)))
            frames += [Frame(f"r{robot}", f"r{robot}/data", t, SIZE, {}) for t in times]
        return sorted(frames, key=lambda frame: frame.t_gen)

    def phases(self) -> tuple[tuple[str, float, float, float], ...]:
        """Name what happened, from when to when it has to be right, and the rate then."""
        return (
            ("constant", STARTED, self.halved, RATE),
            ("halved", self.halved + SETTLED, self.doubled, RATE / 2.0),
            ("doubled", self.doubled + SETTLED, self.end, RATE),
        )


QUICK = Course(teams=(2,), seeds=(1,), halved=8.0, doubled=13.0, end=18.0)


def adaptive_rows(course: Course) -> Iterator[Row]:
    """Yield a row for each arrangement, size of the team and change of the rate."""
    for coordination, transport in ARRANGEMENTS:
        for robots in course.teams:
            yield from _Flights(course, robots, coordination, transport).rows()


@dataclass
class _Flights:
    """Teams that adapt, one a seed, and such with the right limit for each rate, flown when they are asked for."""

    course: Course
    robots: int
    coordination: Coordination
    transport: Transport
    _right: dict[float, list[Team]] = field(default_factory=dict)

    def rows(self) -> Iterator[Row]:
        """Yield a row for each phase."""
        changes = ((self.course.halved, RATE / 2.0), (self.course.doubled, RATE))
        teams = self._fly(ADAPTIVE, RATE, changes)
        asked = f"after {SETTLED:g} s ≥ {100 * ASKED:g} % of a constant limit, in utility and in use"
        for what, since, until, rate in self.course.phases():
            if rate not in self._right:
                self._right[rate] = self._fly(f'limit = "{PART * rate} B/s"', rate)
            right = self._right[rate]
            pairs = zip(teams, right, strict=True)
            shares = [_worth(team, since, until) / _worth(other, since, until) for team, other in pairs]
            share = fmean(shares)
            used, constant = (fmean(_used(each, since, until) for each in flown) / rate for flown in (teams, right))
            measured = [f"{100 * share:.1f} %, worst flight {100 * min(shares):.0f} %"]
            measured += [f"{100 * used:.0f} % of the link (constant {100 * constant:.0f} %)"]
            measured.append(_delay(teams, since, until))
            if what == "constant":
                fair, others = (
                    fmean(_fairness(t, since, until, self.robots) for t in flown) for flown in (teams, right)
                )
                measured.append(f"least robot {100 * fair:.0f} % of the most (constant {100 * others:.0f} %)")
            else:
                measured.append(", ".join(_calm(team, since - SETTLED, until) for team in teams))
            name = f'Rate {what}, limit = "adaptive", {self.robots} robots: {self.coordination}, {self.transport}'
            yield name, asked, ", ".join(measured), "yes" if share >= ASKED and used >= ASKED * constant else "no"

    def _fly(self, limit: str, rate: float, changes: tuple[tuple[float, float], ...] = ()) -> list[Team]:
        teams = []
        for seed in self.course.seeds:
            medium = Medium(rate, DELAY, jitter=JITTER, loss=LOSS, rates=changes, seed=seed)
            team = _team(self.robots, self.coordination, self.transport, limit, medium)
            team.run(self.course.frames(self.robots, seed), self.course.end)
            teams.append(team)
        return teams


def _used(team: Team, since: float, until: float) -> float:
    """Samples on the air [B/s]."""
    return sum(sent.size for sent in team.on_air if sent.frame and since <= sent.t < until) / (until - since)


def _late(team: Team, since: float, until: float) -> list[float]:
    """How long samples were on their way that were sent then [s]."""
    return [d.t_rcv - d.t_sent for d in team.deliveries if d.t_rcv is not None and since <= d.t_sent < until]


def _delay(teams: list[Team], since: float, until: float) -> str:
    late = [each for team in teams for each in _late(team, since, until)]
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
        seed=medium.seed,
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
