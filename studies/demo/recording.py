"""A run as recorded in its events: what each camera published and what of it reached the screen, and when."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from planner.utility import Flags, Floats, Ints, Video
from studies.demo.events import Counts, Event, Links, Publish, Receive, Run, Serve, Tell
from studies.demo.scene import RED
from studies.shown import excess

ALPHA = 10.0
"""How much more red is worth: the scale of a frame is 1 + α × its red fraction (Eq. 9)."""
LOOKS = 20.0
"""How often the screen is looked at for its staleness [1/s]."""

E = TypeVar("E", Publish, Tell, Receive, Serve, Counts, Links)


@dataclass(frozen=True, slots=True)
class Feed:
    """One robot's camera on the operator's screen. Times are seconds since the start of the run.

    Frame i was published at `t_gen[i]` with `size[i]` bytes, `red[i]` of it red. The j-th to be received,
    by the `end` of the run, was frame `frame[j]`, at `t_rcv[j]`.
    """

    robot: str
    t_gen: Floats
    size: Floats
    red: Floats
    frame: Ints
    t_rcv: Floats
    end: float

    @property
    def sees_red(self) -> Flags:
        """Whether the robot sees a red object, frame by frame; other robots' wheels are none."""
        return np.asarray(self.red >= RED)

    @property
    def scale(self) -> Floats:
        """What each frame is worth when fresh [1/s]."""
        return np.asarray(1.0 + ALPHA * self.red)

    @property
    def ages(self) -> Floats:
        """Age of each received frame at its receipt [s]."""
        return np.asarray(self.t_rcv - self.t_gen[self.frame])

    def seconds(self, *, red: bool) -> float:
        """How long the robot sees red, or does not: each frame speaks for the time until the next [s]."""
        lasted = np.diff(np.append(self.t_gen, self.end))
        return float(lasted[self.sees_red == red].sum())

    def staleness(self) -> tuple[Floats, Flags]:
        """Age of what is on the screen [s], and whether the robot sees red, each time one looks.

        Looking begins with the first published frame; until any is received, that one counts as shown.
        """
        times = np.arange(0.0, self.end, 1.0 / LOOKS)
        times = times[times >= self.t_gen[0]]
        shown = np.append(0, self.frame)[np.searchsorted(self.t_rcv, times, side="right")]
        now = np.searchsorted(self.t_gen, times, side="right") - 1
        return times - self.t_gen[shown], self.sees_red[now]

    def ends(self) -> Floats:
        """How long after the robot's last red frame of each time the screen showed a later one [s].

        What it did not show by the end of the run counts up to that.
        """
        over = np.flatnonzero(self.sees_red[:-1] & ~self.sees_red[1:]) + 1
        shown = [self.t_rcv[self.frame >= first] for first in over]
        return np.array([min(t, default=self.end) for t in shown]) - self.t_gen[over]

    def starts(self) -> Floats:
        """How long after the first red frame of each time the screen showed it, or a later one [s]."""
        first = np.flatnonzero(np.diff(np.append(0, self.sees_red.astype(int))) > 0)
        shown = [self.t_rcv[self.frame >= frame] for frame in first]
        return np.array([min(t, default=self.end) for t in shown]) - self.t_gen[first]

    def false_red(self) -> float:
        """How long the screen showed red where the robot saw none [s]."""
        times = np.arange(0.0, self.end, 1.0 / LOOKS)
        times = times[times >= self.t_rcv.min(initial=self.end)]
        shown = self.frame[np.searchsorted(self.t_rcv, times, side="right") - 1] if len(times) else self.frame[:0]
        now = np.searchsorted(self.t_gen, times, side="right") - 1
        return float((self.sees_red[shown] & ~self.sees_red[now]).sum()) / LOOKS

    def utility(self) -> float:
        """Return what the screen was worth over the run, by Eq. 9 and `current` [utility·s]."""
        return self._worth(self.frame, self.t_rcv)

    def utility_undelayed(self) -> float:
        """Return the same, had every frame been received the moment it was published [utility·s]."""
        return self._worth(np.arange(len(self.t_gen)), self.t_gen)

    def _worth(self, frame: Ints, t_rcv: Floats) -> float:
        until = np.append(t_rcv, self.end)[1:]
        born = self.t_gen[frame]
        worth = float((self.scale[frame] * Video().integral(t_rcv - born, until - born)).sum())
        if not len(frame):
            return worth
        _, _, lost = excess((t_rcv, self.scale[frame]), (self.t_gen, self.scale), self.end)
        return worth - float(lost.sum())


@dataclass(frozen=True, slots=True)
class Recording:
    """The conditions of a run, its feeds, and all of its events."""

    run: Run
    feeds: tuple[Feed, ...]
    events: tuple[Event, ...]

    def of(self, kind: type[E]) -> list[E]:
        """Return the events of one kind."""
        return [event for event in self.events if isinstance(event, kind)]


def recordings(events: Iterable[Event]) -> dict[str, Recording]:
    """Sort events into runs, by phase. Raises ValueError for a phase whose conditions are missing."""
    by_phase: dict[str, list[Event]] = {}
    for event in events:
        by_phase.setdefault(event.phase, []).append(event)
    return {phase: _record(phase, of_phase) for phase, of_phase in by_phase.items()}


def _record(phase: str, events: list[Event]) -> Recording:
    run = next((event for event in events if isinstance(event, Run)), None)
    if run is None:
        raise ValueError(f'the events of "{phase}" do not say under which conditions it ran')
    published: dict[str, list[Publish]] = {robot: [] for robot in run.robots}
    received: dict[str, list[Receive]] = {robot: [] for robot in run.robots}
    for event in events:
        if isinstance(event, Publish):
            published[event.robot].append(event)
        elif isinstance(event, Receive) and event.t <= run.start + run.seconds:
            received[event.robot].append(event)
    feeds = tuple(_feed(run, robot, published[robot], received[robot]) for robot in run.robots if published[robot])
    return Recording(run, feeds, tuple(events))


def _feed(run: Run, robot: str, published: list[Publish], received: list[Receive]) -> Feed:
    index = {event.number: place for place, event in enumerate(published)}
    return Feed(
        robot=robot,
        t_gen=np.array([event.t - run.start for event in published]),
        size=np.array([event.size for event in published], dtype=np.float64),
        red=np.array([event.red for event in published], dtype=np.float64),
        frame=np.array([index[event.number] for event in received], dtype=np.int64),
        t_rcv=np.array([event.t - run.start for event in received], dtype=np.float64),
        end=run.seconds,
    )
