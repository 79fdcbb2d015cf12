"""Flights of teams, on all cores, each measured beside its bound and one central decider."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from statistics import fmean

from studies.processes import processes
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.flights import crew, team
from studies.simulation.forecasts import Probe
from studies.simulation.missions import Mission, draw
from studies.simulation.replay import Recorded, decided_alike
from studies.simulation.scores import Yardsticks, measure, reached, same_decisions, sent
from studies.simulation.usage import Usage, usage
from studies.workload import SCENARIOS


@dataclass(frozen=True, slots=True)
class Course:
    """A mission to fly: the place of its scenario in SCENARIOS, its seed, the jitter of its generation times [s].

    Without `jitter` that of the scenario holds.
    """

    scenario: int
    seed: int
    jitter: float | None = None

    def mission(self, how: Conditions) -> Mission:
        """Draw it."""
        scenario = SCENARIOS[self.scenario]
        if self.jitter is not None:
            scenario = replace(scenario, jitter=self.jitter)
        return draw(scenario, self.seed, how)


@dataclass(frozen=True, slots=True)
class Flight:
    """A course, flown under conditions."""

    course: Course
    how: Conditions

    def measured_like(self) -> tuple[Course, int, float, float, int, int]:
        """What the bound and the central decider depend on."""
        how = self.how
        return self.course, how.limit, how.latency, how.seconds, how.robots, how.iterations


@dataclass(frozen=True, slots=True)
class Flown:
    """What a flight reached, as shares, and used; by how much forecasts were off [period], by median and 95 %."""

    flight: Flight
    of_bound: float
    of_central: float
    central_of_bound: float
    used: Usage
    own: tuple[float, float]
    others: tuple[float, float]
    sends: frozenset[int]
    central_messages: float
    """Messages per second that the central decider sends."""
    alike: float | None = None
    """Of wrong clocks: the part of decisions of the flight with right ones that fall alike, each by itself."""

    def same_as(self, other: "Flown") -> float:
        """Return the part of all decisions that are the same in a flight of the same course."""
        return same_decisions(self.flight.course.mission(self.flight.how), self.sends, other.sends)


def fly_all(flights: Iterable[Flight], *, alone: bool = False) -> list[Flown]:
    """Fly them in as many processes as there are cores, or `alone` in this one; what is asked for twice only once.

    Raises OracleUnavailable without SciPy.
    """
    asked = [(flight, repr(flight)) for flight in flights]
    each = {name: flight for flight, name in asked}
    unlike = {flight.measured_like(): flight for flight in each.values()}
    if alone:
        marks = dict(zip(unlike, map(_measure, unlike.values()), strict=True))
        flown = [_fly(flight, marks[flight.measured_like()]) for flight in each.values()]
    else:
        with processes() as pool:
            marks = dict(zip(unlike, pool.map(_measure, unlike.values()), strict=True))
            flown = list(pool.map(_fly, each.values(), [marks[flight.measured_like()] for flight in each.values()]))
    found = dict(zip(each, flown, strict=True))
    return [found[name] for _, name in asked]


def _measure(flight: Flight) -> Yardsticks:
    return measure(flight.course.mission(flight.how), flight.how.iterations)


def _fly(flight: Flight, marks: Yardsticks) -> Flown:
    mission, probe, seed = flight.course.mission(flight.how), Probe(), flight.course.seed
    flying = team(mission, flight.how, seed)
    probe.attach(flying, mission.frames)
    flying.run(mission.frames, mission.problem.t_end)
    worth, central = reached(mission, flying), marks.central(mission, flight.how.loss, seed)
    return Flown(
        flight=flight,
        of_bound=worth / marks.bound,
        of_central=worth / central,
        central_of_bound=central / marks.bound,
        used=usage(mission, flying, flight.how),
        own=probe.own.summary(),
        others=probe.others.summary(),
        sends=sent(mission, flying),
        central_messages=sum(mission.frames[i].t_gen >= WARM_UP for i in marks.sends) / flight.how.seconds,
        alike=_alike(mission, flight) if flight.how.clocks else None,
    )


def _alike(mission: Mission, flight: Flight) -> float:
    """Fly with right clocks, and let every robot live through it again with those of the flight.

    A quick flight is mostly warm-up: no more than half as much again as is scored of it is worth the time.
    """
    right = crew(Recorded, mission, replace(flight.how, clocks={}), flight.course.seed)
    until = min(mission.problem.t_end, 1.5 * flight.how.seconds)
    right.run(mission.frames, until)
    alike = list(decided_alike(right, flight.how.clocks, until))
    return fmean(alike) if alike else 1.0  # a short flight may have nothing to decide
