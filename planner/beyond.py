"""What lies beyond the window: the objective of `best` mode, U and what a plan leaves behind at the window's end.

A window ends, the mission goes on. Taken alone, U of the window has the channel for nothing once the window is
over: plans postpone what is costly to its end, where nobody competes any more, and never get there. So a plan
also answers for the state in which it leaves the streams and the channel. After the window we assume a *steady
state*: every stream goes on to generate as it does in the window, and sends at the regular interval that pays
best when a unit of each constraint has a price. That gives, in closed form,

* the *price* `λ[k]` of a unit of constraint k, at which all streams together use the rate limit / T: the value
  of the last message that the channel carries in the steady state;
* the *rent* `g[i]` [1/s] of stream i: what it earns per second, net of the price of what it sends;
* the *worth* of having m as the last message of its stream at the end `t_c` of the decisions:
  `max over x of the integral of u_m(t) over [t_c, t_n + x], less g[i]·x`, where t_n is when the next message of
  the stream could replace it, and x is how much longer it pays to keep it (the relative value function of the
  renewal process; without a message in its place the stream would earn nothing until t_n);
* the *charge* for what m still occupies after t_last, the last sending of the window: `λ[k] · min(use, limit) ·
  (t_sent + T − t_last)+ / T`, the mean price of the windows to come that hold m; T is stretched for an oversized m.

    objective = U up to t_c + Σ worth of the last message of each stream − Σ charges of the messages sent

That is for `most_recent`. With `current` m also loses what it shows in excess of the newest message generated, as long
as it is kept. With `sum` every message goes on to earn what it has left after the window. With `once` the
first does, less what the stream would earn by sending its first message after the window. With `best`, and where the
caller defines the aggregation, what was received goes on to earn up to the time `until`: when the stream, sending as
often as it pays, will have replaced it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from planner.aggregations.custom import alone
from planner.columns import Columns
from planner.errors import ProblemError
from planner.excess import Excess
from planner.problem import MARKOVIAN, Aggregation, AggregationModel, Problem
from planner.received import integrals
from planner.steady import INTERVALS, Steady, clearing_prices
from planner.utility import Floats, Ints

SHORTEST = 1e-6
"""The least mean interval between messages [s]: some may carry the same time."""


@dataclass(frozen=True, slots=True)
class Beyond:
    """What a plan leaves behind [utility·s].

    By message of the problem: `worth[m]` is added to U when m is the message of its stream that counts at the end of
    the window, `charges[m, k]` taken off for constraint k when m is sent. The `price[k]` is that of a unit of
    constraint k. By stream: `rent[i]` is what it earns a second, net of prices [utility], `until[i]` when its utility
    ends [s].
    """

    worth: Floats
    charges: Floats
    price: Floats
    rent: Floats
    until: Floats

    @property
    def charge(self) -> Floats:
        """What all constraints together take off for each message."""
        return np.asarray(self.charges.sum(axis=1))


def look_beyond(problem: Problem) -> Beyond:
    """Weigh what the messages of a valid problem leave behind: nothing when the mission ends with the window.

    Raises ProblemError when that is not finite.
    """
    streams, nothing = len(problem.streams), np.zeros(len(problem.messages))
    if not problem.goes_on:
        free = np.zeros(len(problem.constraints))
        return Beyond(nothing, nothing[:, None] * free, free, np.zeros(streams), np.full(streams, problem.t_end))
    with np.errstate(over="ignore", invalid="ignore"):
        columns = _over_receivers(problem.columns)
        interval = _intervals(problem, columns)
        steady = _steady(problem, columns, interval)
        after = _after(problem, columns, interval)
        price = clearing_prices(steady, np.array([c.limit / c.window for c in problem.constraints]))
        charge = steady.charge(price)
        net = steady.value - steady.rate * charge[:, None]
        rent = np.zeros(streams)
        rent[steady.stream] = np.maximum(net.max(axis=1), 0.0)
        worth = _worth(problem, columns, rent, interval, after)
        _extend(problem, columns, worth, dict(zip(steady.stream.tolist(), charge.tolist(), strict=True)), interval)
        charges = _charges(problem, columns, price)
        until = _until(problem, steady, net, interval, after)
    if not (np.isfinite(worth).all() and np.isfinite(charges).all() and np.isfinite(until).all()):
        raise ProblemError("the utility beyond the window is not finite: scale or utility parameters are too large")
    return Beyond(worth, charges, price, rent, until)


def _over_receivers(columns: Columns) -> Columns:
    """Return the columns with all receivers of a message taken together: when they get it, and what it is worth."""
    total = columns.share.sum(axis=1)
    late = (columns.delay * columns.share).sum(axis=1) / np.where(total > 0, total, 1.0)
    of = columns.stream
    times = np.stack((columns.t_gen, columns.t_sent, columns.t_rcv + late[of]))
    return columns._replace(times=times, scale=columns.scale * total[of])


def _steady(problem: Problem, columns: Columns, interval: Floats) -> Steady:
    """Take the means over each stream's open messages."""
    opened = columns.opened
    of = columns.stream[opened]
    age, apart = (columns.t_rcv[opened] - columns.t_gen[opened])[:, None], interval[:, None] * INTERVALS
    area = _areas(problem, opened, age, age + apart[of]) * columns.scale[opened][:, None]
    for other, aggregation in _others(problem):
        own = of == other
        if aggregation is Aggregation.SUM:
            area[own] = area[own, -1:]
        elif aggregation is Aggregation.ONCE:
            area[own] = 0.0
        elif isinstance(aggregation, AggregationModel) and own.any():
            first = problem.messages[opened[own.argmax()]]
            area[own] = alone(problem, other, first, apart[other])
    mean = _means(of, len(interval))
    stream = np.flatnonzero(mean.any(axis=1))
    apart = apart[stream]
    return Steady(stream, (mean @ area)[stream] / apart, 1.0 / apart, (mean @ columns.use[opened])[stream])


def _means(of: Ints, streams: int) -> Floats:
    """Return the matrix that takes the mean over the messages of each stream."""
    members = (np.arange(streams)[:, None] == of).astype(np.float64)
    count = np.maximum(members.sum(axis=1, keepdims=True), 1.0)
    return np.asarray(members / count)


def _intervals(problem: Problem, columns: Columns) -> Floats:
    """Return the mean time between the open messages of each stream [s].

    One that has a single message is taken to generate as rarely as the window allows.
    """
    of, t_gen = columns.stream[columns.opened], columns.t_gen[columns.opened]
    streams = len(problem.streams)
    first, last, count = np.full(streams, np.inf), np.full(streams, -np.inf), np.bincount(of, minlength=streams)
    np.minimum.at(first, of, t_gen)
    np.maximum.at(last, of, t_gen)
    lone = (count < 2) | (last <= first)
    rarely = np.maximum(first - t_gen[0], problem.t_end - first)
    gaps = np.where(lone, rarely, last - first) / np.where(lone, 1, count - 1)
    return np.where(count > 0, np.maximum(gaps, SHORTEST), 1.0)


def _areas(problem: Problem, which: Ints, begin: Floats, end: Floats) -> Floats:
    """∫ of the utility of message `which[m]` over the ages `begin[m, 0]` to `end[m, j]` [1]."""
    columns = problem.columns
    begin, rows = np.broadcast_to(begin, end.shape).ravel(), np.repeat(columns.utility[which], end.shape[1])
    return integrals(columns.utilities, rows, begin, end.ravel()).reshape(end.shape)


def _after(problem: Problem, columns: Columns, interval: Floats) -> tuple[float, Floats]:
    """Return t_c, and when the first message of each stream after the window is received [s]."""
    of, t_rcv = columns.stream[columns.opened], columns.t_rcv[columns.opened]
    coming = np.zeros(len(interval))
    np.maximum.at(coming, of, t_rcv + interval[of])
    return min(problem.t_end, float(t_rcv.max())), coming


def _worth(problem: Problem, columns: Columns, rent: Floats, interval: Floats, after: tuple[float, Floats]) -> Floats:
    """What each message is worth as the last of its stream, in place of what it is worth from t_c to t_end."""
    of, t_gen, t_rcv = columns.stream, columns.t_gen, columns.t_rcv
    t_c, coming = after
    soonest = np.maximum(coming - t_c, 0.0)[of, None]
    later = interval[of, None] * np.concatenate((np.zeros(1), INTERVALS))
    begin = np.maximum(t_c - t_gen, 0.0)[:, None]
    end = np.concatenate((begin + soonest + later, np.maximum(problem.t_end - t_gen, 0.0)[:, None]), axis=1)
    end = np.maximum(end, begin)
    area = _areas(problem, np.arange(len(of)), begin, end) * columns.scale[:, None]
    if any(stream.aggregation is Aggregation.CURRENT for stream in problem.streams):
        lost = Excess(problem).finally_lost() * columns.share.sum(axis=1)[of]
        area -= lost[:, None] * (end - begin)
    worth = (area[:, :-1] - rent[of, None] * later).max(axis=1) - area[:, -1]
    return np.where(t_rcv < problem.t_end, worth, 0.0)


def _extend(problem: Problem, columns: Columns, worth: Floats, charge: dict[int, float], interval: Floats) -> None:
    """Put in what messages are worth beyond the window where they do not count as the last of their stream.

    `charge[i]` is that for a message of stream i.
    """
    of, opened = columns.stream, ~columns.sent
    for stream, aggregation in _others(problem):
        own = np.flatnonzero(of == stream)
        worth[own] = 0.0
        if aggregation in (Aggregation.SUM, Aggregation.ONCE) and len(own):
            begin = np.maximum(columns.t_rcv[own], problem.t_end) - columns.t_gen[own]
            life = _areas(problem, own, begin[:, None], (begin + INTERVALS[-1] * interval[stream])[:, None])
            worth[own] = life[:, 0] * columns.scale[own]
            coming = own[opened[own]]
            if aggregation is Aggregation.ONCE and len(coming) > 1:
                age = (columns.t_rcv[coming] - columns.t_gen[coming])[:, None]
                whole = (
                    _areas(problem, coming, age, age + INTERVALS[-1] * interval[stream])[:, 0] * columns.scale[coming]
                )
                worth[own] -= max(float(whole.mean() - charge[stream]), 0.0)


def _until(problem: Problem, steady: Steady, net: Floats, interval: Floats, after: tuple[float, Floats]) -> Floats:
    """Return when what was received of each stream will have been replaced, at t_end or later [s].

    In the middle of the interval at which sending pays best, but not before its next message.
    """
    pause = INTERVALS[-1] * interval
    best, pays = steady.pays_best(net)
    pause[steady.stream[pays]] = 1.0 / steady.rate[pays, best[pays]]
    t_c, coming = after
    return np.asarray(np.maximum(problem.t_end, np.maximum(coming, t_c + 0.5 * pause)))


def _others(problem: Problem) -> Iterator[tuple[int, Aggregation | AggregationModel]]:
    """Yield the streams whose message received last is not all that counts."""
    for kind, streams in problem.columns.kinds:
        if not (isinstance(kind, Aggregation) and kind in MARKOVIAN):
            for stream in streams:
                yield stream, kind


def _charges(problem: Problem, columns: Columns, price: Floats) -> Floats:
    """What the windows after the last decision charge for a message, by constraint."""
    sent, use, t_last = columns.t_sent, columns.use, float(columns.t_sent[columns.opened].max())
    charges = np.zeros((len(sent), len(price)))
    for k, constraint in enumerate(problem.constraints):
        if price[k] > 0 and constraint.limit > 0:
            share = np.minimum(use[:, k], constraint.limit)
            length = constraint.window * np.maximum(use[:, k] / constraint.limit, 1.0)
            charges[:, k] = price[k] * share * np.maximum(sent + length - t_last, 0.0) / constraint.window
    return charges
