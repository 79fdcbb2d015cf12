"""Shares move towards the higher marginal utility per unit, in whole messages.

A robot that may send n messages of a stream per window T, evenly, gains n·∫ u(a) da over [latency, latency + T/n]
per window. T is the longest window of all constraints; a shorter one T' sees up to ⌈n·T'/T⌉ of the messages. The first
message is worth what it adds to what was last sent, and nothing where none will be generated within the window: that is
how robots take turns where the limits carry fewer messages than there are robots. From nothing, the message with the
greatest marginal utility per unit is added while all limits carry it, so that nobody gets of one what is of no use
without the others; the unit is the part of that limit of which a message uses the largest part. The sum per robot and
constraint is its *target*. Whoever holds more than its target has spare, whoever holds less has a lack. All robots
work out the same gifts from the same view, and each makes its own, of what it does not use.
"""

import heapq
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from planner import MessageUtility

KEEP = 2.0
"""What a robot holds must be worth this much more to another one before it moves."""
MARGIN = 1.01
"""Room for messages a little larger than the last one."""
MOST = 64
"""Messages of one stream per window that are told apart."""


@dataclass(frozen=True, slots=True)
class Claim:
    """What one stream could do with the constraints.

    `use` is what one message uses of each [its units], `scale` its value factor for all receivers, `period` and
    `latency` are in seconds, `age` is that of the last sent message (of `last_scale`) when the next one is generated,
    `wait` the time until then [s].
    """

    robot: str
    use: tuple[float, ...]
    scale: float
    utility: MessageUtility
    period: float
    latency: float
    age: float
    last_scale: float
    wait: float


@dataclass(frozen=True, slots=True)
class Room:
    """A constraint to share out: `limit` of it in all within any `window` [s], and what each robot holds now."""

    limit: float
    window: float
    held: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Gift:
    """An amount of the constraint that `giver` should grant to `taker`."""

    giver: str
    taker: str
    amount: float


_Step = tuple[float, list[float]]
"""The marginal utility of a message, and what it needs of each room besides what those before it need."""
_Offer = tuple[float, str, int, int, list[_Step]]
"""Negated worth, robot, number of the claim, messages before this one, all steps of the claim."""


def marginals(claim: Claim, window: float, cost: float) -> list[float]:
    """Marginal utility of the first, second, … message per window, by what one costs; it does not increase."""
    if claim.wait > window or cost <= 0.0:
        return []
    most = int(min(MOST, max(1.0, np.ceil(window / max(claim.period, 1e-6)))))
    life = max(window, claim.period)
    ages = np.array([claim.latency, claim.latency + claim.age])
    fresh, old = claim.utility.integral(ages, ages + life)
    counts = np.arange(1, most + 1)
    start = np.full(most, claim.latency)
    values = counts * claim.utility.integral(start, start + window / counts)
    first = fresh - old * claim.last_scale / max(claim.scale, 1e-9)
    gains = np.concatenate(([first], np.diff(values)))
    return [gain * claim.scale / cost for gain in _concave(gains.tolist())]


def targets(claims: Iterable[Claim], rooms: Sequence[Room]) -> list[dict[str, float]]:
    """What each robot should hold of each room: whole messages, by marginal utility, while all rooms carry them."""
    kept = [dict(room.held) for room in rooms]
    heap: list[_Offer] = []
    for number, claim in enumerate(claims):
        steps = _steps(claim, rooms)
        if steps:
            heapq.heappush(heap, _offer(claim.robot, steps, 0, number, kept))
    target: list[dict[str, float]] = [defaultdict(float) for _ in rooms]
    left = [room.limit for room in rooms]
    while heap:
        _, robot, number, n, steps = heapq.heappop(heap)
        worth, needs = steps[n]
        if worth <= 0.0 or any(need > room for need, room in zip(needs, left, strict=True)):
            continue
        for k, need in enumerate(needs):
            left[k] -= need
            target[k][robot] += need
        if n + 1 < len(steps):
            heapq.heappush(heap, _offer(robot, steps, n + 1, number, kept))
    return [dict(each) for each in target]


def gifts(target: Mapping[str, float], held: Mapping[str, float], least: float) -> list[Gift]:
    """Who should give how much (more than `least`) to whom so that all hold their targets, as far as it goes."""
    spare = {robot: amount - target.get(robot, 0.0) for robot, amount in held.items()}
    givers = sorted((r for r in spare if spare[r] > least), key=lambda r: (-spare[r], r))
    takers = sorted((r for r in spare if spare[r] < -least), key=lambda r: (spare[r], r))
    moves = []
    for taker in takers:
        for giver in givers:
            amount = min(-spare[taker], spare[giver])
            if amount > least:
                moves.append(Gift(giver, taker, amount))
                spare[taker] += amount
                spare[giver] -= amount
    return moves


def _concave(gains: list[float]) -> list[float]:
    """Gains as they come at best: a message that pays only together with the next ones counts with their mean."""
    pools: list[tuple[float, int]] = []
    for gain in gains:
        total, count = gain, 1
        while pools and total * pools[-1][1] > pools[-1][0] * count:
            before = pools.pop()
            total, count = total + before[0], count + before[1]
        pools.append((total, count))
    return [total / count for total, count in pools for _ in range(count)]


def _steps(claim: Claim, rooms: Sequence[Room]) -> list[_Step]:
    """The messages of a claim one by one; a message costs the largest part that it takes of any room."""
    window = max((room.window for room in rooms), default=0.0)
    parts = [use / max(room.limit, 1e-9) for use, room in zip(claim.use, rooms, strict=True)]
    gains = marginals(claim, window, max(parts, default=0.0))
    return [
        (gain, [_need(use, n, room.window / window) for use, room in zip(claim.use, rooms, strict=True)])
        for n, gain in enumerate(gains)
    ]


def _need(use: float, n: int, part: float) -> float:
    """What message number `n` (from 0) adds to what a window holds at most, if it is that part of the longest."""
    return use * MARGIN * (_seen(n + 1, part) - _seen(n, part))


def _seen(count: int, part: float) -> int:
    """How many of so many messages, evenly apart, lie within that part of their window at most."""
    return math.ceil(count * part - 1e-9)


def _offer(robot: str, steps: list[_Step], n: int, number: int, kept: list[dict[str, float]]) -> _Offer:
    """Message number `n` of a claim; one that the robot already holds the room for counts more."""
    worth, needs = steps[n]
    has = all(room.get(robot, 0.0) >= 0.9 * need for room, need in zip(kept, needs, strict=True))
    if has:
        for room, need in zip(kept, needs, strict=True):
            room[robot] = room.get(robot, 0.0) - need
    return (-worth * (KEEP if has else 1.0), robot, number, n, steps)
