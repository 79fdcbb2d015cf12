"""What a run could have been at best: the offline optimum under the spec's limit, with all frames known."""

from dataclasses import dataclass

import numpy as np

from planner import Aggregation, Message, Problem, Stream
from planner.measures import Throughput
from planner.utility import Video
from studies.demo.recording import Recording
from studies.oracle import OracleUnavailable, upper_bound


@dataclass(frozen=True, slots=True)
class Optimum:
    """The bound on the utility [utility·s], and its plan's frame rates while robots see red or not [1/s]."""

    utility: float
    fps_red: float | None
    fps_other: float | None


def find_optimum(recording: Recording) -> Optimum | None:
    """Solve the linear programme; None without SciPy.

    A frame arrives `size / rate` after it was taken, as if the medium had nothing else to carry: no run is
    better.
    """
    frames = _frames(recording)
    try:
        sends = upper_bound(_problem(recording, frames, Aggregation.CURRENT))
    except OracleUnavailable:
        return None
    red = np.array([recording.feeds[stream].sees_red[i] for _, stream, i in frames])
    rates = [
        float(sends.sends[red == wanted].sum()) / seconds if seconds else None
        for wanted in (True, False)
        for seconds in (sum(feed.seconds(red=wanted) for feed in recording.feeds),)
    ]
    return Optimum(sends.utility, *rates)


def problem_of(recording: Recording, aggregation: Aggregation) -> Problem:
    """Return the frames of a run as messages."""
    return _problem(recording, _frames(recording), aggregation)


def _frames(recording: Recording) -> list[tuple[float, int, int]]:
    """Return when each frame was taken, of which feed it is, and its number there."""
    return sorted(
        (float(feed.t_gen[i]), stream, i) for stream, feed in enumerate(recording.feeds) for i in range(len(feed.t_gen))
    )


def _problem(recording: Recording, frames: list[tuple[float, int, int]], aggregation: Aggregation) -> Problem:
    run, feeds = recording.run, recording.feeds
    messages = tuple(
        Message(
            stream=stream,
            t_gen=t_gen,
            t_sent=t_gen,
            t_rcv=t_gen + 8 * float(feeds[stream].size[i]) / run.rate,
            utility=Video(),
            scale=float(feeds[stream].scale[i]),
            use=(float(feeds[stream].size[i]),),
        )
        for t_gen, stream, i in frames
    )
    return Problem(
        streams=tuple(Stream(robot, aggregation) for robot in range(len(feeds))),
        messages=messages,
        current=0,
        constraints=(Throughput(run.limit / 8, run.window).constraint("throughput"),),
        traffic=(),
        t_start=0.0,
        t_end=run.seconds,
    )
