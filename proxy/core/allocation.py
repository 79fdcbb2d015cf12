"""Shares move towards the higher marginal utility per unit, in whole messages.

A robot that may send n messages of a stream per window T, evenly, gains n·∫ u(a) da over [latency, latency + T/n]
per window. The first message is worth what it adds to what was last sent, and nothing where none will be generated
within the window: that is how robots take turns where the limit carries fewer messages than there are robots. From
nothing, the message with the greatest marginal utility per unit is added while the limit carries it; the sum per
robot is its *target*. Whoever holds more than its target has spare, whoever holds less has a lack. All robots work
out the same gifts from the same view, and each makes its own, of what it does not use.
"""

import heapq
from collections import defaultdict
from collections.abc import Iterable, Mapping
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
    """What one stream could do with a constraint.

    `use` is what one message uses [units], `scale` its value factor for all receivers, `period` and `latency` are in
    seconds, `age` is that of the last sent message (of `last_scale`) when the next one is generated, `wait` the time
    until then [s].
    """

    robot: str
    use: float
    scale: float
    utility: MessageUtility
    period: float
    latency: float
    age: float
    last_scale: float
    wait: float


@dataclass(frozen=True, slots=True)
class Gift:
    """An amount of the constraint that `giver` should grant to `taker`."""

    giver: str
    taker: str
    amount: float


_Offer = tuple[float, str, int, int, Claim, list[float]]
"""Negated worth, robot, number of the claim, messages before this one, the claim, its marginal utilities."""


def marginals(claim: Claim, window: float) -> list[float]:
    """Marginal utility of the first, second, … message per window, per unit of use; it does not increase."""
    if claim.wait > window or claim.use <= 0.0:
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
    return [gain * claim.scale / claim.use for gain in _concave(gains.tolist())]


def targets(claims: Iterable[Claim], limit: float, window: float, held: Mapping[str, float]) -> dict[str, float]:
    """What each robot should hold: whole messages, by marginal utility per unit, while the limit carries them."""
    kept = dict(held)
    heap: list[_Offer] = []
    for number, claim in enumerate(claims):
        worth = marginals(claim, window)
        if worth:
            heapq.heappush(heap, _offer(claim, worth, 0, number, kept))
    target: dict[str, float] = defaultdict(float)
    left = limit
    while heap:
        _, _, number, n, claim, worth = heapq.heappop(heap)
        use = claim.use * MARGIN
        if worth[n] <= 0.0 or use > left:
            continue
        left -= use
        target[claim.robot] += use
        if n + 1 < len(worth):
            heapq.heappush(heap, _offer(claim, worth, n + 1, number, kept))
    return dict(target)


def gifts(target: Mapping[str, float], held: Mapping[str, float]) -> list[Gift]:
    """Who should give how much to whom so that all hold their targets, as far as what is held goes."""
    spare = {robot: amount - target.get(robot, 0.0) for robot, amount in held.items()}
    givers = sorted((r for r in spare if spare[r] > 1.0), key=lambda r: (-spare[r], r))
    takers = sorted((r for r in spare if spare[r] < -1.0), key=lambda r: (spare[r], r))
    moves = []
    for taker in takers:
        for giver in givers:
            amount = min(-spare[taker], spare[giver])
            if amount > 1.0:
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


def _offer(claim: Claim, worth: list[float], n: int, number: int, kept: dict[str, float]) -> _Offer:
    """The next message of a claim; one that the robot already holds the room for counts more."""
    use = claim.use * MARGIN
    has = kept.get(claim.robot, 0.0) >= 0.9 * use
    if has:
        kept[claim.robot] -= use
    return (-worth[n] * (KEEP if has else 1.0), claim.robot, number, n, claim, worth)
