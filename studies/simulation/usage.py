"""What a flight used of its limit."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.missions import Mission
from studies.simulation.records import Flown, OnAir


@dataclass(frozen=True, slots=True)
class Usage:
    """What was sent after the warm-up; windows are those that end with a send.

    `messages` per second. `exceeding` is the part of windows whose messages exceed what the limit leaves to them,
    `worst` by how many of the largest messages at most, rounded up. `together` is the part of windows in which messages
    and what robots tell each other exceed the limit. `told` is that, in B/s per robot, copies counted, and `interval`
    the mean time between two digests of a robot [s].
    """

    messages: float
    exceeding: float
    worst: int
    together: float
    told: float
    interval: float


def usage(flown: Mission, flight: Flown, how: Conditions) -> Usage:
    """Count what a flight sent."""
    messages = [sent for sent in flight.on_air if sent.frame is not None]
    told = [sent for sent in flight.on_air if sent.frame is None and sent.t >= WARM_UP]
    digests = sum(sent.digest for sent in told)
    held = _windows(messages, how.window)
    largest = max(frame.size for frame in flown.frames)
    together = _windows(flight.on_air, how.window)
    return Usage(
        messages=len(held) / how.seconds,
        exceeding=float(np.mean(held > flown.carried * (1 + 1e-9))) if len(held) else 0.0,
        worst=math.ceil(max(0.0, float(held.max(initial=0.0)) - flown.carried) / largest - 1e-9),
        together=float(np.mean(together > flown.gross * (1 + 1e-9))) if len(together) else 0.0,
        told=sum(sent.size for sent in told) / how.seconds / how.members,
        interval=how.seconds * how.members / max(digests, 1),
    )


def _windows(sent: Sequence[OnAir], window: float) -> npt.NDArray[np.float64]:
    """Return the bytes of every closed window that ends with a send after the warm-up."""
    times = np.array([each.t for each in sent], dtype=np.float64)
    sums = np.concatenate(([0.0], np.cumsum([float(each.size) for each in sent])))
    first = np.searchsorted(times, times - window, "left")
    last = np.searchsorted(times, times, "right")
    return np.asarray((sums[last] - sums[first])[times >= WARM_UP])
