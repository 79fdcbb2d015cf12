"""The missions that are drawn: the paper's three scenarios (§4.2), and real traffic.

The same code draws the same missions, byte for byte.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from studies.bench.format import FIRST, FORMAT, Head, LimitTable, Mission, Row, StreamTable
from studies.bench.utilities import table_of
from studies.bench.worth import bounded
from studies.simulation import conditions
from studies.simulation.missions import SIZE, scenario
from studies.simulation.traffic.missions import draw
from studies.simulation.traffic.workloads import WORKLOADS
from studies.workload import mission as paper_mission

SEED = 2021
"""Of all missions."""
TIME, NUMBER = 4, 5
"""Digits behind the point: of times [0.1 ms], and of slopes and scales."""
PLACEHOLDER = 1.0
"""Stands for what is computed at last."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A mission that is drawn when it is asked for."""

    name: str
    make: Callable[[Head], Mission]
    about: str
    seconds: float
    warm_up: float = 5.0
    latency: float = 0.02
    loss: float = 0.0

    def mission(self) -> Mission:
        """Draw it, and bound it. Raises OracleUnavailable without SciPy."""
        head = Head(
            format=FORMAT,
            name=self.name,
            about=self.about,
            seconds=self.seconds,
            warm_up=self.warm_up,
            latency=self.latency,
            loss=self.loss,
            seed=SEED,
            limits=(LimitTable(kind="messages", limit=5.0, window=conditions.WINDOW),),
            columns=FIRST,
            bound=PLACEHOLDER,
            all=PLACEHOLDER,
        )
        return bounded(self.make(head))


def _paper(which: str, head: Head) -> Mission:
    """Draw a mission of equal messages: ten robots of 1 Hz each, of whom five may send in 2.5 s."""
    problem = paper_mission(scenario(which), SEED, seconds=head.seconds, latency=head.latency)
    streams, own = [], [[m for m in problem.messages if m.stream == s] for s in range(len(problem.streams))]
    for number, messages in enumerate(own):
        slope = round(sum(m.utility.slope for m in messages) / len(messages), NUMBER)  # type: ignore[attr-defined]
        utility = {"kind": "linear", "u0": 1.0, "slope": slope}
        streams.append(_stream(number, "sample", "most_recent", messages[0].scale, utility))
    rows = [
        Row(round(m.t_gen, TIME), m.stream, SIZE, slope=round(m.utility.slope, NUMBER))  # type: ignore[attr-defined]
        for m in problem.messages
    ]
    return Mission(head.model_copy(update={"columns": (*FIRST, "slope")}), tuple(streams), _ordered(rows, head))


def _traffic(which: str, robots: int, head: Head) -> Mission:
    """Draw a mission of real traffic."""
    workload = WORKLOADS[which](robots)
    drawn = draw(which, robots, SEED, head.seconds, latency=head.latency, everybody=True)
    kinds = [(robot, kind) for robot, own in enumerate(workload.robots) for kind in own]
    streams = [_stream(r, k.name, k.aggregation, k.weight, table_of(k.utility)) for r, k in kinds]
    rows = [
        Row(round(m.t_gen, TIME), m.stream, int(m.use[0]), round(m.scale / kinds[m.stream][1].weight, NUMBER))
        for m in drawn.problem.messages
    ]
    limit = LimitTable(kind="throughput", limit=workload.rate * workload.window, window=workload.window)
    scaled = ("scale",) if any(row.scale != 1.0 for row in rows) else ()
    head = head.model_copy(update={"columns": (*FIRST, *scaled), "limits": (limit,)})
    return Mission(head, tuple(streams), _ordered(rows, head))


def _stream(robot: int, name: str, aggregation: str, weight: float, utility: dict[str, object]) -> StreamTable:
    return StreamTable(
        robot=f"r{robot}", key=f"r{robot}/{name}", aggregation=aggregation, weight=weight, utility=utility
    )


def _ordered(rows: list[Row], head: Head) -> tuple[Row, ...]:
    """Put samples in order: rounded times may be equal, or those of the end."""
    return tuple(sorted(row for row in rows if row.t_gen < head.seconds))


GENERATED = (
    Drawn(
        "paper-few",
        partial(_paper, "few"),
        "§4.2 of the paper: ten robots, equal messages, a few of them very important",
        seconds=60.0,
        warm_up=conditions.WARM_UP,
    ),
    Drawn(
        "paper-mixed",
        partial(_paper, "mixed"),
        "§4.2 of the paper: from unimportant messages to important ones",
        seconds=60.0,
        warm_up=conditions.WARM_UP,
    ),
    Drawn(
        "paper-most",
        partial(_paper, "most"),
        "§4.2 of the paper: most messages very important; late, and a few are lost",
        seconds=60.0,
        warm_up=conditions.WARM_UP,
        latency=0.1,
        loss=0.02,
    ),
    Drawn(
        "traffic-mixed",
        partial(_traffic, "mixed", 4),
        "four robots with a camera, odometry, telemetry, a log and alarms on 1 Mbit/s",
        seconds=25.0,
    ),
    Drawn(
        "traffic-random",
        partial(_traffic, "random", 5),
        "five robots, samples of 1 to 40 kB at random times on 1 Mbit/s; some are lost",
        seconds=30.0,
        loss=0.05,
    ),
    Drawn(
        "traffic-cameras",
        partial(_traffic, "cameras", 4),
        "four cameras on 2.7 Mbit/s, of which one sees something red now and then",
        seconds=30.0,
        latency=0.05,
    ),
    Drawn(
        "traffic-crowd",
        partial(_traffic, "crowd", 12),
        "twelve robots with five small streams each, of all rates, on 0.48 Mbit/s",
        seconds=17.0,
    ),
)
"""All missions that are drawn, in the order of tables."""
