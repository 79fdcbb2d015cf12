"""What a flight of real traffic reached, used and told."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any, Literal, Protocol

import numpy as np

from planner import Aggregation, Message
from planner.utility import Flags, Floats
from proxy.core.view.subscribers import intersects
from studies.shown import excess
from studies.simulation.records import Delivery, OnAir
from studies.simulation.traffic.missions import WARM_UP, Mission
from utility_specs.lifetimes import initial

DRAWS = 20
"""So many draws of what is lost on the air."""
LONG = 10.0
"""So long a span shows whether a limit is kept for good [s]; all windows of drawn workloads divide it."""
EXACT = 1e-9
"""Part of a limit by which sums may be wrong."""


class Flight(Protocol):
    """What was sent, by receiver, and all bytes on the air in the order of their times."""

    deliveries: list[Delivery]
    on_air: list[OnAir]


@dataclass(frozen=True, slots=True)
class Score:
    """What was reached after the warm-up.

    `utility` is that of all receivers [utility·s], `large` that of what is not small. `sent` are bytes of samples,
    `offered` those that were generated, copies included, and `room` what the limit has for samples if nobody tells
    anything. `over` is the part of all samples whose window exceeds the limit when they are sent, `worst` the fullest
    window of all, in limits, as is `largest`, the largest sample; `sustained` is what the fullest 10 s hold, as a part
    of what the limit allows in that time: at most one where windows divide it and none is over. `told` is what robots
    tell each other, `digests` the part of it in digests, `allowed` what it may be [B/s]. Of small samples `arrived` is
    the part that came to a receiver, `kept` that which was sent, `age` the age then (median, 95th percentile) [s]. Of
    alarms: those generated, and sent. `silence` is by robot the longest time without a sample [s].
    """

    utility: float
    large: float
    sent: float
    offered: float
    room: float
    over: float
    worst: float
    sustained: float
    largest: float
    told: float
    digests: float
    allowed: float
    arrived: float
    kept: float
    age: tuple[float, float]
    alarms: int
    alarms_sent: int
    silence: dict[str, float]
    has_small: bool

    @property
    def fill(self) -> float:
        """Bytes sent, as a part of what the limit or the offer allows."""
        return self.sent / max(min(self.room, self.offered), 1.0)


def score(mission: Mission, flight: Flight, loss: float) -> Score:
    """Judge a flight of the mission in which so much was lost."""
    number = {id(frame): i for i, frame in enumerate(mission.frames)}
    seconds = mission.problem.t_end - WARM_UP
    sends = [(air.t, number[id(air.frame)], air.size) for air in flight.on_air if air.frame is not None]
    told = [air for air in flight.on_air if air.frame is None and air.t >= WARM_UP]
    due = {i for i, frame in enumerate(mission.frames) if frame.t_gen >= WARM_UP}
    sent = {i for _, i, _ in sends}
    copies = sum(size for _, _, size in sends) / max(sum(mission.frames[i].size for _, i, _ in sends), 1)
    arrived, ages = _small(mission, flight, due, number)
    over, worst = _windows(mission, flight.on_air)
    utility, large = _reached(mission, flight, number, loss)
    return Score(
        utility=utility,
        large=large,
        sent=float(sum(size for t, _, size in sends if t >= WARM_UP)),
        offered=copies * sum(mission.frames[i].size for i in due),
        room=mission.carried * seconds / mission.window,
        over=over,
        worst=worst,
        sustained=_sustained(mission, flight.on_air),
        largest=max(frame.size for frame in mission.frames) / mission.limit,
        told=sum(air.size for air in told) / seconds,
        digests=sum(air.size for air in told if air.digest) / seconds,
        allowed=mission.allowed,
        arrived=arrived,
        kept=_part(len(due & mission.small & sent), len(due & mission.small)),
        age=ages,
        alarms=len(due & mission.alarms),
        alarms_sent=len(due & mission.alarms & sent),
        silence=_silence(mission, sends),
        has_small=bool(mission.small),
    )


def worth(mission: Mission, times: dict[int, float]) -> float:
    """Return what the frames are worth that one receiver got at these times, by index [utility·s]."""
    streams: dict[int, list[Message]] = defaultdict(list)
    for index, t_rcv in times.items():
        message = mission.problem.messages[index]
        streams[message.stream].append(message._replace(t_rcv=max(t_rcv, message.t_rcv, WARM_UP)))
    return sum(_worth(mission, stream, received) for stream, received in streams.items())


def _worth(mission: Mission, stream: int, received: list[Message]) -> float:
    """Return what the samples of one stream are worth: most recent or current ones, or the sum of all."""
    problem = mission.problem
    received = sorted((m for m in received if m.t_rcv < problem.t_end), key=lambda m: m.t_rcv)
    if not received:
        return 0.0
    begins = np.array([m.t_rcv for m in received])
    ends = np.append(begins[1:], problem.t_end)
    kind = problem.streams[stream].aggregation
    if kind == Aggregation.SUM:
        ends[:] = problem.t_end
    whole = sum(
        float(np.sum(scales * utility.integral(ages, until)))
        for utility, scales, ages, until in _by_utility(received, begins, ends)
    )
    return whole - (_lost(mission, stream, received) if kind is Aggregation.CURRENT else 0.0)


def _lost(mission: Mission, stream: int, received: list[Message]) -> float:
    """Return what is lost while one stream of `current` shows too much."""
    begins, scales = np.array([m.t_rcv for m in received]), np.array([m.scale for m in received])
    _, which, shown = excess((begins, scales), mission.generated[stream], mission.problem.t_end)
    each = zip(which.tolist(), shown.tolist(), strict=True)
    return float(sum(initial(received[at].utility) * lost for at, lost in each if lost))


def _by_utility(received: Sequence[Message], begins: Floats, ends: Floats) -> list[tuple[Any, Floats, Floats, Floats]]:
    """Group the samples by their function of age: scales, ages at receipt and ages at the end of their time."""
    born, scales = np.array([m.t_gen for m in received]), np.array([m.scale for m in received])
    places: dict[Any, list[int]] = defaultdict(list)
    for place, message in enumerate(received):
        places[message.utility].append(place)
    return [(utility, scales[at], (begins - born)[at], (ends - born)[at]) for utility, at in places.items()]


def _reached(mission: Mission, flight: Flight, number: dict[int, int], loss: float) -> tuple[float, float]:
    """Return what receivers get of all that was sent, and of what is not small, by the mean over draws of loss.

    Whether a sample is lost does not depend on who sends when: else two flights would differ by their luck with alarms.
    """
    whole, large = 0.0, 0.0
    random = np.random.default_rng(DRAWS)
    for receiver in mission.receivers:
        sent = {number[id(d.frame)]: d for d in flight.deliveries if d.receiver == receiver}
        delay = median([d.t_rcv - d.t_sent for d in sent.values() if d.t_rcv is not None] or [0.0])
        times = {i: d.t_sent + delay if d.t_rcv is None else d.t_rcv for i, d in sent.items()}
        draws = random.random((DRAWS if loss else 1, len(mission.frames)))
        arrived = [{i: t for i, t in times.items() if fate[i] >= loss} for fate in draws]
        whole += fmean(worth(mission, each) for each in arrived)
        large += fmean(worth(mission, {i: t for i, t in each.items() if i not in mission.small}) for each in arrived)
    return whole, large


def _wanting(mission: Mission, key: str, sender: str) -> int:
    """Return how many others wanted a key when the flight began."""
    others = (keys for robot, keys in mission.interests.items() if robot != sender)
    return sum(any(intersects(expression, key) for expression in keys) for keys in others)


def _small(
    mission: Mission, flight: Flight, due: set[int], number: dict[int, int]
) -> tuple[float, tuple[float, float]]:
    """Return the part of small samples that came to a receiver, and how old they were."""
    counted = due & mission.small
    published = Counter((mission.frames[i].key, mission.frames[i].robot) for i in counted)
    wanted = sum(count * _wanting(mission, *of) for of, count in published.items())
    ages = [
        d.t_rcv - d.frame.t_gen for d in flight.deliveries if d.t_rcv is not None and number[id(d.frame)] in counted
    ]
    middle, late = np.quantile(ages, (0.5, 0.95)).tolist() if ages else (0.0, 0.0)
    return _part(len(ages), wanted), (middle, late)


def _part(some: int, of: int) -> float:
    return some / of if of else 1.0


def held(mission: Mission, sent: Sequence[OnAir]) -> tuple[Floats, Floats]:
    """Return when each sample was sent [s], and what the closed window that ends then holds of all sends [B]."""
    times, held, sample = _held(sent, mission.window)
    return times[sample], held[sample]


def _held(
    sent: Sequence[OnAir], window: float, begins: Literal["left", "right"] = "left"
) -> tuple[Floats, Floats, Flags]:
    """Return of everything that was sent the time, what the window holds that ends then, and whether it is a sample.

    Windows are closed; if one `begins` at the right of its first moment, what was sent in that moment is not in it.
    """
    ordered = sorted(sent, key=lambda air: air.t)
    times = np.array([air.t for air in ordered], dtype=np.float64)
    sums = np.concatenate(([0.0], np.cumsum([float(air.size) for air in ordered])))
    held = sums[np.searchsorted(times, times, "right")] - sums[np.searchsorted(times, times - window, begins)]
    return times, held, np.array([air.frame is not None for air in ordered], dtype=np.bool_)


def _windows(mission: Mission, sent: Sequence[OnAir]) -> tuple[float, float]:
    """Return the part of samples whose closed window exceeds the limit, and the fullest window of all sends."""
    times, held, sample = _held(sent, mission.window)
    scored = times >= WARM_UP
    over = held[scored & sample] > mission.limit * (1 + EXACT)
    return float(over.mean()) if len(over) else 0.0, float(held[scored].max(initial=0.0) / mission.limit)


def _sustained(mission: Mission, sent: Sequence[OnAir]) -> float:
    """Return what the fullest half-open span of `LONG` holds of all sends, as a part of what the limit allows then."""
    times, held, _ = _held(sent, LONG, begins="right")
    return float(held[times >= WARM_UP].max(initial=0.0) / (mission.limit * LONG / mission.window))


def _silence(mission: Mission, sends: Sequence[tuple[float, int, int]]) -> dict[str, float]:
    """Return of each robot the longest time after the warm-up without a sample of its own, whoever sends it [s]."""
    robots = [frame.key.partition("/")[0] for frame in mission.frames]
    times: dict[str, list[float]] = {robot: [WARM_UP] for robot in robots}
    for t, index, _ in sends:
        if t >= WARM_UP:
            times[robots[index]].append(t)
    end = mission.problem.t_end
    return {robot: float(np.diff([*sorted(own), end]).max()) for robot, own in times.items()}
