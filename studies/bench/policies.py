"""What a policy is asked, what it may know, and how one is found by its name on the command line.

A policy is a class with one method, `decide(sample, situation) -> bool`: send this sample of mine, which was generated
just now? Every robot has an object of its own, made without arguments, so a policy may remember what it likes.
"""

import importlib
import importlib.util
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np

from planner import Constraint, Message, Problem
from studies.bench.errors import BenchError
from studies.central import Policy
from studies.policies import whenever_it_fits
from utility_specs.suggestions import hint


class Sample(NamedTuple):
    """A sample as a robot knows it: of which `stream` (a number) and whose robot it is, and when it was generated [s].

    `use` is what it takes of each limit: bytes of a throughput, 1 of a number of messages. `arrives` is when it is, or
    will be, received [s].
    """

    stream: int
    robot: int
    t_gen: float
    use: tuple[float, ...]
    arrives: float
    message: Message

    def value(self, t: float) -> float:
        """Return what it is worth a second at `t` [s] if that is the sample that counts then."""
        age = np.array([max(0.0, t - self.t_gen)])
        return self.message.scale * float(self.message.utility.value(age)[0])

    def worth(self, begin: float, end: float) -> float:
        """Return what it is worth from `begin` to `end` [s] if that is the sample that counts then [utility·s]."""
        ages = np.array([max(0.0, begin - self.t_gen)]), np.array([max(0.0, begin - self.t_gen, end - self.t_gen)])
        return self.message.scale * float(self.message.utility.integral(*ages)[0])


@dataclass(frozen=True)
class Situation:
    """What the robot knows that decides: it has heard some of what others sent, and nothing of what they did not.

    `window` is the same as the planner gets it: what was sent, the sample, and what is expected.
    """

    window: Problem

    @property
    def now(self) -> float:
        """The time [s]; all clocks show the same."""
        return self.window.messages[self.window.current].t_gen

    @property
    def limits(self) -> tuple[Constraint, ...]:
        """The limits of all robots together: `limit` bytes or messages in any `window` [s]."""
        return self.window.constraints

    @cached_property
    def sent(self) -> tuple[Sample, ...]:
        """What was sent as far as the robot knows: its own samples and what it heard, oldest first.

        What no limit counts any more is left out, but for the last sample of each stream.
        """
        return tuple(self._sample(m) for m in self.window.messages if m.sent)

    @cached_property
    def expected(self) -> tuple[Sample, ...]:
        """What is expected of all streams heard of, by their rhythm and means so far: soonest first.

        Those from before now are of others, who may have sent them and not been heard yet.
        """
        current = self.window.messages[self.window.current]
        return tuple(self._sample(m) for m in self.window.messages if not m.sent and m is not current)

    def shown(self, stream: int) -> Sample | None:
        """Return the sample of a stream that was sent last; None before the first."""
        return next((sample for sample in reversed(self.sent) if sample.stream == stream), None)

    def room(self) -> tuple[float, ...]:
        """Return what is left of each limit as far as the robot knows, the sample not counted."""
        return tuple(
            c.limit - sum(m.use[k] for m in self.window.messages if m.sent and m.t_sent >= self.now - c.window)
            for k, c in enumerate(self.limits)
        )

    def fits(self) -> bool:
        """Whether the sample fits as far as the robot knows; what does not, the channel refuses."""
        return whenever_it_fits(self.window)

    @cached_property
    def sample(self) -> Sample:
        """The sample to decide."""
        return self._sample(self.window.messages[self.window.current])

    def _sample(self, message: Message) -> Sample:
        robot = self.window.streams[message.stream].robot
        return Sample(message.stream, robot, message.t_gen, message.use, message.t_rcv, message)


class Decider(Protocol):
    """A policy of the benchmark."""

    def decide(self, sample: Sample, situation: Situation) -> bool:
        """Return whether to send the sample."""


def load(name: str) -> type[Decider]:
    """Return the class called `module:Class` or `file.py:Class`. Raises BenchError."""
    place, colon, wanted = name.rpartition(":")
    if not (place and colon and wanted.isidentifier()):
        raise BenchError(f"policy {name}: it is named as module:Class or file.py:Class")
    module = _file(name, Path(place)) if place.endswith(".py") else _module(name, place)
    found = getattr(module, wanted, None)
    if found is None:
        classes = [word for word, each in vars(module).items() if isinstance(each, type)]
        raise BenchError(f'policy {name}: {place} has no class "{wanted}"{hint(wanted, classes)}')
    if not (isinstance(found, type) and callable(getattr(found, "decide", None))):
        raise BenchError(f"policy {name}: it is no class with a method decide(self, sample, situation)")
    return found


def asking(name: str, kind: type[Decider]) -> Policy:
    """Return a new object of the policy as one that decides windows. It raises BenchError where the policy fails."""
    decider = _guarded(name, kind)

    def decide(window: Problem) -> bool:
        situation = Situation(window)
        answer: Any = _guarded(name, lambda: decider.decide(situation.sample, situation))
        if not isinstance(answer, bool | np.bool_):
            raise BenchError(f"policy {name}: decide returned {answer!r}, neither True nor False")
        return bool(answer)

    return decide


def _guarded(name: str, call: Callable[[], Any]) -> Any:
    try:
        return call()
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(last.filename).name}:{last.lineno}"
        raise BenchError(f"policy {name}: {type(error).__name__}: {error} ({where})") from error


def _file(name: str, path: Path) -> Any:
    if not path.is_file():
        raise BenchError(f"policy {name}: there is no file {path}")
    spec = importlib.util.spec_from_file_location(f"sendworthy_policy_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise BenchError(f"policy {name}: {path} is no module of Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    loader = spec.loader
    _guarded(name, lambda: loader.exec_module(module))
    return module


def _module(name: str, place: str) -> Any:
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    return _guarded(name, lambda: importlib.import_module(place))
