"""Workloads that nobody chose: teams, rates, sizes and utilities are drawn, and flown beside one central decider.

`python -m studies.simulation.traffic.drawn` prints one line for each, and writes a page of the worst. Workloads that
were chosen are those a coordination was tuned on; each of the first drawn ones that reached less than 70 % of central
showed a fault. What is flown again and again is tuned on, too: other seeds reached 92.6 % in the mean where those had
reached 95.1. So each day draws its own, unless a first seed is named.

Robots of a team are equal, or with `--unequal` each has kinds of its own (`unequal_teams` says how they differ): the
first forty such teams showed a stream that held up twelve robots for ever. With `--audiences` robots share some kinds,
and the operator looks at one robot after the other (`audiences` says how). Flights of two minutes (`--seconds 110`)
showed a team that sent 4.5 times the limit after 72 s; so each line has the fullest 10 s.
"""

import argparse
import math
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, date, datetime
from functools import partial
from pathlib import Path
from statistics import fmean

import numpy as np

from planner import Exponential, Linear, Step, Video
from planner.utility import MessageUtility
from proxy.core.model.settings import UNICAST
from studies.benchmarks.report import Table, write_page
from studies.processes import processes
from studies.simulation.churn import Happening
from studies.simulation.traffic import audiences, unequal_teams
from studies.simulation.traffic.audiences import Audience, Interests
from studies.simulation.traffic.flights import How, fly, fly_alone
from studies.simulation.traffic.kinds import Kind, middle
from studies.simulation.traffic.missions import draw_from
from studies.simulation.traffic.scores import score
from studies.simulation.traffic.workloads import MBIT, Workload

ROBOTS = (2, 3, 4, 6, 8, 12)
WINDOWS = (0.5, 1.0, 2.5)
"""[s]"""
RATES = (0.3, 1.0, 3.0)
"""Limits [Mbit/s]."""
LATENCIES = (0.002, 0.02)
"""[s]"""
BEFORE = (0.0, 5.0, 30.0)
"""So long before the applications the daemons begin [s]: what they tell each other of themselves may be paid for."""
UTILITIES: tuple[MessageUtility, ...] = (
    *(Exponential(1.0, lasting) for lasting in (0.5, 2.0, 5.0, 20.0)),
    *(Linear(1.0, slope) for slope in (0.2, 0.7, 2.0)),
    *(Step(1.0, lasting) for lasting in (0.5, 2.0, 10.0)),
    Video(1 / 30, 10.0),
)
SIZES, FREQUENCIES = (0.01, 0.45), (0.4, 15.0)
"""Typical sizes, as parts of the limit, and rates of a stream [Hz]."""
SPREAD = 1.2
"""Rates of the streams of one kind differ by this factor at most from its own."""
LOADS = (1.2, 40.0)
"""What is offered, in limits: below all fits, far above no robot has anything."""
SHOWN = 25
"""The page shows so many, the worst first..."""
SHOWN_OVER = 10
"""... and so many of those that exceeded the limit most often."""
COLUMNS = ("workload", "of central", "windows over", "fullest", "10 s", "fill", "central", "silent [s]", "central")
NOTE = (
    "Sizes in limits; 10 s: what the fullest 10 s hold of what the limit allows in that time; fill: bytes sent of what"
    " limit or offer allow; silent: the longest time that one of the robots sends nothing, also as it pauses or nobody"
    " wants anything of it."
)
TITLE = "Drawn workloads in simulation"


@dataclass(frozen=True, slots=True)
class Drawn:
    """A workload, and how it is flown. `load` is what is offered, in limits; of `unequal` teams more than there is.

    Where it is drawn who wants what, all copies of what somebody wants.
    """

    seed: int
    workload: Workload
    how: How
    load: float
    unequal: bool = False
    wanted: Mapping[str, Audience] = field(default_factory=dict, hash=False)
    """Who wants each kind, by its name; none: an operator, and where samples are broadcast everybody, wants all."""

    def interests(self, seconds: float) -> Interests:
        """Draw who subscribes to what in a flight so long [s]."""
        return audiences.interests(_random(self.seed, "views"), self.workload, self.wanted, seconds)

    @property
    def label(self) -> str:
        """Tell what it is like in a line, and how it is flown."""
        how = self.how
        lost = f"{how.loss:.0%} lost, " if how.loss else ""
        return self._told(f"{how.transport}, {how.latency * 1e3:.0f} ms, {lost}{how.before:g} s before, ")

    @property
    def offer(self) -> str:
        """Tell what it is like in a line."""
        return self._told("")

    def _told(self, how: str) -> str:
        workload = self.workload
        kinds = ", ".join(map(self._told_of, workload.kinds))
        robots = f"{len(workload.robots)} {'unequal ' if self.unequal else ''}robots"
        where = f"{robots}, {how}{workload.rate / MBIT:g} Mbit/s, {workload.window:g} s"
        return f"{self.seed}: {where}: {kinds}"

    def _told_of(self, kind: Kind) -> str:
        """Tell its mean rate, its largest typical size, and how many robots of an unequal team have it."""
        workload = self.workload
        size = max(kind.sizes) / (workload.rate * workload.window)
        told = f"{type(kind.utility).__name__} {middle(kind.rates):.1f} Hz {size:.2f} limits"
        told += f"{' anew' if kind.anew else ''}{' at random' if kind.at_random else ''}"
        told += f" of {sum(kind in own for own in workload.robots)}" if self.unequal else ""
        return f"{told} {self.wanted[kind.name].label}" if kind.name in self.wanted else told

    @property
    def disputed(self) -> bool:
        """Whether not all of it fits, and not hardly any."""
        return LOADS[0] < self.load < LOADS[1]


@dataclass(frozen=True, slots=True)
class Reached:
    """What a team reached of a central decider's utility; `over`, `worst` and `sustained` are as in a score.

    The team's and the central decider's: `fills`, and `silences`, the longest time that a robot sent nothing [s].
    """

    drawn: Drawn
    part: float
    over: float
    worst: float
    sustained: float
    fills: tuple[float, float]
    silences: tuple[float, float]


def first_seed(day: date) -> int:
    """Return the first of the seeds that nothing was tuned on before that day: the day's number, and three digits."""
    return 1000 * int(f"{day:%Y%m%d}")


def drawn_by(seed: int, *, unequal: bool = False, shared: bool = False) -> Drawn:
    """Draw a workload; an unequal team has the kinds of the equal one of the same seed, and one more.

    Where streams are `shared` also who wants what: in unicast, as a broadcast costs no more for many.
    """
    draw = np.random.default_rng(seed)
    robots, window = int(draw.choice(ROBOTS)), float(draw.choice(WINDOWS))
    rate = float(draw.choice(RATES)) * MBIT
    kinds = tuple(_kind(draw, f"kind-{number}", rate * window) for number in range(int(draw.choice((1, 1, 2, 3)))))
    transport, latency = str(draw.choice(("unicast", "broadcast"))), float(draw.choice(LATENCIES))
    how = How(transport=transport, latency=latency, loss=0.0, before=float(draw.choice(BEFORE)))
    team = (kinds,) * robots
    if unequal:
        # All that is drawn for unequal teams only comes last: so the seeds of equal teams draw what they always did.
        kinds = (*kinds, _kind(draw, f"kind-{len(kinds)}", rate * window))
        team = unequal_teams.team(draw, kinds, robots)
        latency, loss = float(draw.choice(unequal_teams.LATENCIES)), float(draw.choice(unequal_teams.LOSSES))
        how = replace(how, latency=latency, loss=loss)
    offered = sum(middle(kind.rates) * middle(kind.sizes) for own in team for kind in own)
    drawn = Drawn(seed, Workload(f"drawn-{seed}", team, rate, window), how, offered / rate, unequal)
    if not shared:
        return drawn
    wanted = audiences.audiences(_random(seed, "audiences"), drawn.workload)
    load = audiences.offered(drawn.workload, wanted) / rate
    return replace(drawn, how=replace(how, transport=UNICAST), load=load, wanted=wanted)


def _random(seed: int, what: str) -> np.random.Generator:
    """Return random numbers for who wants what: so the seeds draw the same teams as without that."""
    return np.random.default_rng([seed, *what.encode()])


def _kind(draw: np.random.Generator, name: str, limit: float) -> Kind:
    part, rate = (float(np.exp(draw.uniform(*np.log(between)))) for between in (SIZES, FREQUENCIES))
    size, anew = max(60.0, part * limit), bool(draw.random() < 0.3)
    return Kind(
        name,
        UTILITIES[int(draw.integers(len(UTILITIES)))],
        (rate / SPREAD, rate * SPREAD),
        ((0.4 if anew else 0.9) * size, 1.1 * size),
        weight=float(draw.choice((1.0, 1.0, 2.0, 8.0))),
        anew=anew,
        at_random=bool(draw.random() < 0.3),
        spread=0.05,
        jitter=float(draw.choice((0.001, 0.01))),
    )


def reach(seed: int, seconds: float, *, unequal: bool = False, shared: bool = False) -> Reached | None:
    """Fly what a seed draws, so long with the warm-up [s]; None where all of it fits, or hardly any."""
    drawn = drawn_by(seed, unequal=unequal, shared=shared)
    if not drawn.disputed:
        return None
    how = drawn.how
    changes: Sequence[Happening] = ()
    mission = draw_from(drawn.workload, seed, seconds, latency=how.latency, everybody=how.broadcasts)
    if shared:
        wishes = drawn.interests(seconds)
        mission, changes = replace(mission, interests=wishes.first, receivers=tuple(wishes.first)), wishes.changes
    team = score(mission, fly(mission, how, seed, changes), how.loss)
    central = score(*fly_alone(mission, how, seed, changes), how.loss)
    part, silent = team.utility / central.utility, [max(each.silence.values()) for each in (team, central)]
    return Reached(
        drawn, part, team.over, team.worst, team.sustained, (team.fill, central.fill), (silent[0], silent[1])
    )


def line(found: Reached) -> str:
    """Return a result in one line."""
    return (
        f"{found.part:.1%} of central, {found.over:.1%} of windows over, worst {found.worst:.2f},"
        f" fullest 10 s {found.sustained:.2f}, silent {found.silences[0]:.1f} s ({found.silences[1]:.1f} central);"
        f" {found.drawn.label}"
    )


def last_line(found: Sequence[Reached]) -> str:
    """Return what came of all in one line."""
    parts, over = [each.part for each in found], fmean(each.over for each in found)
    return (
        f"{len(found)} flights, {fmean(parts):.1%} of central ({min(parts):.1%} at least), {over:.1%} of windows over,"
        f" fullest 10 s {max(each.sustained for each in found):.2f}"
    )


def tables(found: Sequence[Reached], seconds: float) -> list[Table]:
    """Return how much was reached, the worst, and where most windows were over the limit."""
    various = any(each.drawn.unequal for each in found)
    note = f"{len(found)} workloads, flights of {seconds:g} s; {unequal_teams.TOLD if various else 'without loss.'}"
    note += f" Who wants what is drawn, too: {audiences.TOLD}" if any(each.drawn.wanted for each in found) else ""
    transports = sorted({each.drawn.how.transport for each in found})
    worst = sorted(found, key=lambda each: each.part)[:SHOWN]
    fullest = sorted([each for each in found if each.over > 0.0], key=lambda each: -each.over)[:SHOWN_OVER]
    return [
        Table(
            "Utility, of one central decider's",
            ("transport", "workloads", "mean", "least", "5 %", "10 %", "25 %", "median", "windows over", "10 s"),
            tuple(_summary(name, [each for each in found if each.drawn.how.transport == name]) for name in transports),
            note,
        ),
        Table("The worst", COLUMNS, _rows(worst), NOTE),
        Table("Most windows over the limit", COLUMNS, _rows(fullest)),
    ]


def _summary(transport: str, found: Sequence[Reached]) -> tuple[str, ...]:
    parts = np.array([each.part for each in found])
    shares = [parts.mean(), *(np.quantile(parts, quantile) for quantile in (0.0, 0.05, 0.1, 0.25, 0.5))]
    over = np.mean([each.over for each in found])
    longest = f"{max(each.sustained for each in found):.2f}"
    return transport, str(len(found)), *(f"{share:.1%}" for share in shares), f"{over:.1%}", longest


def _rows(found: Sequence[Reached]) -> tuple[tuple[str, ...], ...]:
    return tuple(
        (
            each.drawn.label,
            f"{each.part:.1%}",
            f"{each.over:.1%}",
            f"{each.worst:.2f}",
            f"{each.sustained:.2f}",
            *(f"{fill:.0%}" for fill in each.fills),
            *(f"{silence:.1f}" for silence in each.silences),
        )
        for each in found
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly what seeds draw; print each, and write the page if a file is named. Return 1 where 10 s hold too much."""
    parser = _parser()
    options = parser.parse_args(arguments)
    seeds, found = range(options.first, options.first + options.seeds), list[Reached]()
    with processes(options.jobs) as pool:
        one = partial(reach, seconds=options.seconds, unequal=options.unequal, shared=options.audiences)
        for each in pool.map(one, seeds):
            if each is not None:
                found.append(each)
                print(line(each), flush=True)
    if not found:
        parser.error("none of these seeds draws a team that has something to dispute")
    print(last_line(found))
    if options.output:
        write_page(options.output, TITLE, tables(found, options.seconds), datetime.now(UTC), _command(options))
    return int(max(each.sustained for each in found) > options.at_most)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.simulation.traffic.drawn",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--first", type=int, default=first_seed(datetime.now(UTC).date()), help="first seed (default: by the day)")
    add("--seeds", type=int, default=240, help="so many of them are drawn (default: 240)")
    add("--unequal", action="store_true", help="teams whose robots have kinds of their own")
    add("--audiences", action="store_true", help="who wants what is drawn, too; in unicast")
    add("--seconds", type=float, default=30.0, help="of a flight, 5 s of warm-up included (default: 30)")
    add("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: one for each core)")
    add("--at-most", type=float, default=math.inf, help="fail where 10 s hold more than so many times the limit")
    add("--output", type=Path, help="write the tables there, as a Markdown page")
    return parser


def _command(options: argparse.Namespace) -> str:
    """Return the command that flies the same again."""
    asked = f"--first {options.first} --seeds {options.seeds} --seconds {options.seconds:g}"
    flags = "".join(f" --{name}" for name in ("unequal", "audiences") if getattr(options, name))
    return f"python -m studies.simulation.traffic.drawn {asked}{flags}"


if __name__ == "__main__":
    sys.exit(main())
