"""What is to be tried: specs and limits for the robots of a recording, and the way to whoever wants their samples."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from planner import Constraint, MessageUtility
from planner.measures import Measure, Throughput
from studies.replay.samples import Sample
from utility_specs import ConstraintSpec, InformationType, Specs
from utility_specs.features import Size

LATENCY = 0.01
"""From a robot to the operator, unless somebody says otherwise [s]."""
RATE = 1e7
"""Of the medium [B/s]; limits lie far below, so that no queue shows."""
FASTER = 10.0
"""The medium is at least so many times as fast as the limits."""
UNCOVERED = "(no spec)"
"""What stands for the type of samples that no information type covers."""


@dataclass(frozen=True, slots=True)
class Limit:
    """A constraint: that of all robots together, or that of the robot with this number alone."""

    name: str
    measure: Measure
    robot: int | None = None

    @property
    def constraint(self) -> Constraint:
        """As the planner has it."""
        return self.measure.constraint(self.name)


@dataclass(frozen=True)
class Mission:
    """The `robots` whose traffic is flown by these specs to one operator, who wants everything `latency` [s] away.

    So large a part of what is sent to him is lost as `loss`.
    """

    specs: Specs
    robots: tuple[str, ...]
    latency: float = LATENCY
    loss: float = 0.0

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """The constraints, those that each robot has for itself once for every robot."""
        shared = [Limit(spec.name, spec.measure) for spec in self.specs.constraints if not spec.measure.private]
        own = [
            Limit(spec.name, spec.measure, robot)
            for spec in self.specs.constraints
            if spec.measure.private
            for robot in range(len(self.robots))
        ]
        return tuple(shared + own)

    def use(self, size: int, robot: int) -> tuple[float, ...]:
        """Return what a sample of this size of the robot with this number uses of each limit."""
        return tuple(
            limit.measure.use(size, 1, own=True) if limit.robot in (None, robot) else 0.0 for limit in self.limits
        )

    @property
    def rate(self) -> float:
        """That of the medium [B/s]."""
        paces = [limit.measure.pace for limit in self.limits if limit.measure.pace < float("inf")]
        return max([RATE, *(FASTER * pace for pace in paces)])

    @property
    def operator(self) -> str:
        """A name that no robot has."""
        name = "operator"
        while name in self.robots:
            name += "-"
        return name


def with_limit(specs: Specs, rate: float) -> Specs:
    """Return specs with this throughput [B/s] instead of theirs, or besides other constraints where they have none."""
    others = [spec for spec in specs.constraints if not isinstance(spec.measure, Throughput)]
    before = [spec for spec in specs.constraints if isinstance(spec.measure, Throughput)]
    if before:
        windows = {spec.measure.window: spec.name for spec in before}
        ours = [ConstraintSpec(name, Throughput(rate, window)) for window, name in windows.items()]
    else:
        ours = [ConstraintSpec("throughput", Throughput(rate))]
    return replace(specs, constraints=(*ours, *others), generation=f"{specs.generation}+{rate:g}")


def features_of(covering: InformationType, sample: Sample) -> dict[str, float]:
    """Return the features of a sample: from its payload where that was recorded, else those that were recorded."""
    if sample.payload is not None:
        return covering.extract(sample.key, sample.payload)
    found = {name: float(sample.size) for name, feature in covering.features if isinstance(feature, Size)}
    found |= {name: sample.features[name] for name, _ in covering.features if name in sample.features}
    keyed = [(name, feature) for name, feature in covering.features if name not in found and not feature.reads_payload]
    if keyed:
        found |= replace(covering, features=tuple(keyed)).extract(sample.key, b"")
    return covering.completed(found)


def lacking(covering: InformationType, sample: Sample) -> list[str]:
    """Return the features of which nothing was recorded, so that their defaults hold."""
    if sample.payload is not None:
        return []
    read = [name for name, each in covering.features if each.reads_payload and not isinstance(each, Size)]
    return [name for name in read if name not in sample.features]


def worth_key(covering: InformationType, features: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Return what tells the utility of a sample from that of others of its stream: features, or nothing."""
    return tuple(features.items()) if covering.told(features) else ()


def utility_of(covering: InformationType, key: tuple[tuple[str, float], ...]) -> MessageUtility:
    """Return the utility that `worth_key` stands for."""
    return covering.utility_of(dict(key))
