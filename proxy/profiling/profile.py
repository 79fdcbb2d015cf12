"""A profile: where the processor time of a daemon went, by stage and by stack."""

import sys
import threading
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from proxy.profiling.stages import OTHER, STAGES, ZENOH, stage_of
from proxy.profiling.threads import is_zenohs

if TYPE_CHECKING:
    from proxy.profiling.sampler import Spent

MOST = 1000
"""Stacks that a profile tells apart; of the others only the stage is told."""
REST = "(the rest)"
THREADING = threading.__name__
"""What every thread of Python begins with says nothing."""


@dataclass(frozen=True, slots=True)
class Samples:
    """What crossed meanwhile: samples of applications that were decided on, that passed, and that came for them."""

    decided: int
    passed: int
    delivered: int

    def since(self, before: "Samples") -> "Samples":
        """Return what came since then."""
        return Samples(self.decided - before.decided, self.passed - before.passed, self.delivered - before.delivered)

    @property
    def total(self) -> int:
        """All of them."""
        return self.decided + self.passed + self.delivered


@dataclass(frozen=True, slots=True)
class Branch:
    """A stack, the outermost function first behind its thread, its stage, and what was spent in it [s]."""

    stage: str
    frames: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, slots=True)
class Profile:
    """What a `robot`'s daemon spent in so many `seconds`, found in so many `looks`; `own` is what they took [s]."""

    robot: str
    seconds: float
    looks: int
    own: float
    samples: Samples
    branches: tuple[Branch, ...]

    @property
    def stages(self) -> dict[str, float]:
        """What each stage took [s], in their order."""
        spent = defaultdict[str, float](float)
        for branch in self.branches:
            spent[branch.stage] += branch.seconds
        return {stage: spent[stage] for stage in STAGES}

    def brief(self) -> dict[str, Any]:
        """Return it as plain JSON data, without stacks."""
        return {
            "robot": self.robot,
            "seconds": self.seconds,
            "looks": self.looks,
            "own": self.own,
            "samples": asdict(self.samples),
            "stages": self.stages,
        }

    def write(self) -> dict[str, Any]:
        """Return it as plain JSON data, which `read` reads."""
        stacks = [{"stage": each.stage, "seconds": each.seconds, "frames": list(each.frames)} for each in self.branches]
        return self.brief() | {"stacks": stacks}


def read(data: Mapping[str, Any]) -> Profile:
    """Return the profile that was written. Raises KeyError, TypeError or ValueError for anything else."""
    return Profile(
        str(data["robot"]),
        float(data["seconds"]),
        int(data["looks"]),
        float(data["own"]),
        Samples(**data["samples"]),
        tuple(
            Branch(str(each["stage"]), tuple(map(str, each["frames"])), float(each["seconds"]))
            for each in data["stacks"]
        ),
    )


def branches(spent: "Iterable[Spent]", whole: float) -> tuple[Branch, ...]:
    """Return what was spent by stack, most first; of `whole` [s] what no thread took that was seen is there, too."""
    sums = defaultdict[tuple[str, tuple[str, ...]], float](float)
    for stage, frames, seconds in _named(spent):
        sums[stage, frames] += seconds
    unseen = whole - sum(sums.values())
    if unseen > 0.0:
        sums[OTHER, ("threads that came and went",)] = unseen
    ordered = sorted(sums.items(), key=lambda each: -each[1])
    found = [Branch(stage, frames, seconds) for (stage, frames), seconds in ordered[:MOST]]
    rest = defaultdict[str, float](float)
    for (stage, _), seconds in ordered[MOST:]:
        rest[stage] += seconds
    return (*found, *(Branch(stage, (REST,), seconds) for stage, seconds in rest.items()))


def _named(spent: "Iterable[Spent]") -> Iterator[tuple[str, tuple[str, ...], float]]:
    """Yield stages, threads and functions by name; threads of Zenoh that do the same are one."""
    modules = {getattr(module, "__file__", None): name for name, module in list(sys.modules.items())}
    for each in spent:
        within = [modules.get(function.file) or function.file for function in each.stack]
        zenohs = is_zenohs(each.thread)
        stage = stage_of(within) if each.stack or not zenohs else ZENOH
        thread = f"zenoh {each.thread.partition('-')[0]}" if zenohs else each.thread
        named = [f"{of.name} ({name})" for of, name in zip(each.stack, within, strict=True) if name != THREADING]
        yield stage, (thread, *reversed(named)), each.seconds
