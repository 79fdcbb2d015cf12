"""A flight of real daemons as an experiment: what an operator got, as a share of the best there could have been."""

from dataclasses import dataclass

import numpy as np

from planner import Message, Problem, Stream
from planner.measures import Throughput
from planner.utility import Video
from studies.oracle import upper_bound


@dataclass(frozen=True)
class Camera:
    """Publishes samples of `size` [B] on `key`, `rate` a second."""

    key: str
    size: int
    rate: float


def utility_share(cameras, heard, *, limit, window):
    """Return the utility of what was heard as a share of the offline optimum's at the same latency.

    All of it is of type `video`, under one limit of throughput [bit/s] in windows of `window` [s]. What was published
    and not heard is taken to have been published at the camera's pace. The latency is that of the quickest samples:
    what the others waited is lost.
    """
    end = max(sample["heard"] for sample in heard)
    start = min(sample["heard"] for sample in heard)
    received = [[s for s in heard if s["key"] == camera.key] for camera in cameras]
    worth = sum(_worth(samples, end) for samples in received)
    messages = [
        message
        for stream, (camera, samples) in enumerate(zip(cameras, received, strict=True))
        for message in _published(stream, camera, samples, start, end)
    ]
    best = upper_bound(
        Problem(
            streams=tuple(Stream(robot) for robot in range(len(cameras))),
            messages=tuple(sorted(messages, key=lambda m: (m.t_gen, m.stream))),
            current=0,
            constraints=(Throughput(limit / 8, window).constraint("throughput"),),
            traffic=(),
            t_start=0.0,
            t_end=end,
        )
    )
    return worth / best.utility


def _worth(samples, end):
    """What the samples of one camera were worth to who received them, the newest counting at each time."""
    best, worth = -np.inf, 0.0
    for sample, until in zip(samples, [s["heard"] for s in samples[1:]] + [end], strict=True):
        best = max(best, sample["sent"])
        worth += float(Video().integral(np.array(sample["heard"] - best), np.array(until - best)))
    return worth


def _published(stream, camera, samples, start, end):
    """Every sample of a camera while others were heard, each as late as the quickest of those that came."""
    begin = np.median([s["sent"] - s["number"] / camera.rate for s in samples])
    latency = np.quantile([s["heard"] - s["sent"] for s in samples], 0.05)
    first, last = int(np.ceil((start - begin) * camera.rate)), int((end - begin) * camera.rate)
    for number in range(first, last):
        t_gen = begin + number / camera.rate
        yield Message(stream, t_gen, t_gen, t_gen + latency, Video(), 1.0, (float(camera.size),))
