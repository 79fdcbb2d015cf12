"""What became of every sample, column by column: some fifty bytes for each, however large its payload was."""

from array import array
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from planner import Aggregation, AggregationModel, MessageUtility
from planner.utility import Flags, Floats, Ints
from studies.replay.mission import UNCOVERED, Mission, features_of, lacking, utility_of, worth_key
from studies.replay.samples import Fate, Sample
from utility_specs import InformationType

NOT = LOST = float("nan")
"""When a sample was sent or received that was not."""
UNDECIDED = "undecided"
"""What became of samples that still waited when the recording ended."""


@dataclass(frozen=True, slots=True)
class StreamOf:
    """The samples of one key of the robot with this number; `covering` is None where no information type does."""

    robot: int
    key: str
    covering: InformationType | None

    @property
    def type_name(self) -> str:
        """What its information type is called."""
        return UNCOVERED if self.covering is None else self.covering.name

    @property
    def planned(self) -> bool:
        """Whether anybody decides on its samples."""
        return self.covering is not None and self.covering.planned

    @property
    def aggregation(self) -> Aggregation | AggregationModel:
        """How its samples combine."""
        return Aggregation.MOST_RECENT if self.covering is None else self.covering.aggregation


@dataclass(frozen=True)
class Columns:
    """All samples in the order in which they were published. Times are seconds since the first, sizes bytes.

    `fate` and `recorded` are places in `reasons`; `worth` is that of a utility, see `Outcomes.utility`.
    """

    t: Floats
    t_gen: Floats
    t_sent: Floats
    t_rcv: Floats
    size: Ints
    scale: Floats
    stream: Ints
    worth: Ints
    fate: Ints
    recorded: Ints

    @cached_property
    def sent(self) -> Flags:
        """Which samples went to the mesh."""
        return np.asarray(~np.isnan(self.t_sent))


class Outcomes:
    """Takes in samples and what becomes of them."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.streams: list[StreamOf] = []
        self.reasons: list[str] = [UNDECIDED]
        self.seconds: dict[str, list[float]] = {}
        """By type what the searches for its samples took together [s], and how many there were."""
        self.lacking: Counter[str] = Counter()
        """Of how many samples a feature, by type and name, was not recorded."""
        self._numbers: dict[tuple[str, int], int] = {}
        """Samples whose fate is not told yet, by robot and their number there."""
        self._robots = {robot: number for number, robot in enumerate(mission.robots)}
        self._places: dict[tuple[str, str], int] = {}
        self._worths: dict[tuple[int, tuple[tuple[str, float], ...]], int] = {}
        self._keys: list[tuple[int, tuple[tuple[str, float], ...]]] = []
        self._floats = {name: array("d") for name in ("t", "t_gen", "t_sent", "t_rcv", "scale")}
        self._ints = {name: array("q") for name in ("size", "stream", "worth", "fate", "recorded")}

    def __len__(self) -> int:
        return len(self._ints["size"])

    def stream(self, robot: str, key: str) -> int:
        """Return the place of a stream, new or known."""
        place = self._places.get((robot, key))
        if place is None:
            place = self._places[robot, key] = len(self.streams)
            self.streams.append(StreamOf(self._robots[robot], key, self.mission.specs.match(key)))
        return place

    def enter(self, sample: Sample, t: float) -> tuple[int, Mapping[str, float]]:
        """Take in a sample that is published at `t` [s since the first]; return its number and its features."""
        stream = self.stream(sample.robot, sample.key)
        covering = self.streams[stream].covering
        features: Mapping[str, float] = {}
        scale, key = 0.0, tuple[tuple[str, float], ...]()
        if covering is not None:
            features = features_of(covering, sample)
            scale, key = covering.scale(features), worth_key(covering, features)
            self.lacking.update(f"{covering.name}.{name}" for name in lacking(covering, sample))
        worth = self._worths.setdefault((stream, key), len(self._worths))
        t_gen = t - max(0.0, sample.t - sample.t_gen)
        for name, number in {"t": t, "t_gen": t_gen, "t_sent": NOT, "t_rcv": NOT, "scale": scale}.items():
            self._floats[name].append(number)
        for name, whole in {"size": sample.size, "stream": stream, "worth": worth, "fate": 0, "recorded": 0}.items():
            self._ints[name].append(whole)
        self._numbers[sample.robot, sample.number] = len(self) - 1
        return len(self) - 1, features

    def of(self, number: int) -> StreamOf:
        """Return the stream of a sample."""
        return self.streams[self._ints["stream"][number]]

    def send(self, number: int, t: float, arrival: float, reason: str) -> None:
        """The sample was sent at `t` [s], and arrives, or is `LOST`."""
        self._floats["t_sent"][number], self._floats["t_rcv"][number] = t, arrival
        self.settle(number, reason)

    def settle(self, number: int, reason: str) -> None:
        """Note what became of a sample."""
        self._ints["fate"][number] = self._reason(reason)

    def note(self, fate: Fate) -> int | None:
        """Note what became of a sample when it was recorded; return its number if it is known."""
        number = self._numbers.pop((fate.robot, fate.number), None)
        if number is not None:
            self._ints["recorded"][number] = self._reason(fate.reason)
        return number

    def searched(self, number: int, seconds: float) -> None:
        """A search for the sample took so long."""
        took = self.seconds.setdefault(self.of(number).type_name, [0.0, 0])
        took[0] += seconds
        took[1] += 1

    def utility(self, worth: int) -> MessageUtility:
        """Return the utility of samples with this `worth`; only covered ones have any."""
        if len(self._keys) < len(self._worths):
            self._keys = list(self._worths)
        stream, key = self._keys[worth]
        covering = self.streams[stream].covering
        if covering is None:
            raise LookupError(f"stream {stream} is covered by no information type")
        return utility_of(covering, key)

    def columns(self) -> Columns:
        """Return everything taken in so far."""
        arrays: dict[str, Any] = {name: np.array(values) for name, values in (self._floats | self._ints).items()}
        return Columns(**arrays)

    def _reason(self, reason: str) -> int:
        if reason not in self.reasons:
            self.reasons.append(reason)
        return self.reasons.index(reason)
