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
* the *charge* for what m still occupies: `λ[k] · min(use, limit) · (t_sent + T − t_c)+ / T`, the mean price of
  the windows to come that hold m.

    objective = U up to t_c + Σ worth of the last message of each stream − Σ charges of the messages sent
"""

from dataclasses import dataclass

import numpy as np

from planner.errors import ProblemError
from planner.evaluation import Gains, integrals
from planner.problem import Problem
from planner.utility import Floats, Ints

INTERVALS = np.array([1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 50, 100, 300], dtype=np.float64)
"""The intervals between sends that are tried for a stream, in its mean intervals between messages."""

SHORTEST = 1e-6
"""The least mean interval between messages [s]: some may carry the same time."""

SWEEPS = 3
"""How often the prices of several constraints are fitted to each other."""


@dataclass(frozen=True, slots=True)
class Beyond:
    """What a plan leaves behind, by message of the problem [utility·s].

    `worth[m]` is added to U when m is the last message of its stream, `charge[m]` taken off when m is sent. The
    `price[k]` is that of a unit of constraint k, the `rent[i]` what stream i earns a second, net of it [utility].
    """

    worth: Floats
    charge: Floats
    price: Floats
    rent: Floats

    def aim(self, problem: Problem, gains: Gains) -> tuple[Floats, float]:
        """Return what each of the gains adds to the objective, and the objective of the facts alone [utility·s]."""
        opened = np.flatnonzero([not m.sent for m in problem.messages])
        level = np.repeat(np.arange(len(opened)), np.diff(gains.start))
        worth = np.append(self.worth, 0.0)
        left = np.where(gains.lasts[level], worth[opened[level]] - worth[gains.replaced], 0.0)
        facts = [i for i, m in enumerate(problem.messages) if m.sent]
        last = {problem.messages[i].stream: i for i in sorted(facts, key=lambda i: problem.messages[i].t_rcv)}
        charged = self.charge[opened[level]]
        return gains.gain + left - charged, gains.facts + float(self.worth[list(last.values())].sum())


@dataclass(frozen=True, slots=True)
class _Steady:
    """The streams that go on, and what each earns and uses by the interval between its sends.

    `value[i, j]` and `rate[i, j]`: utility per second and sends per second at interval j; `use[i, k]` per send.
    """

    stream: Ints
    value: Floats
    rate: Floats
    use: Floats


def look_beyond(problem: Problem) -> Beyond:
    """Weigh what the messages of a valid problem leave behind: nothing when the mission ends with the window.

    Raises ProblemError when that is not finite.
    """
    nothing = np.zeros(len(problem.messages))
    if not problem.goes_on:
        return Beyond(nothing, nothing, np.zeros(len(problem.constraints)), np.zeros(len(problem.streams)))
    columns = np.array([(m.stream, m.sent, m.t_gen, m.t_sent, m.t_rcv, m.scale) for m in problem.messages])
    use = np.array([m.use for m in problem.messages]).reshape(len(columns), len(problem.constraints))
    interval = _intervals(problem, columns)
    with np.errstate(over="ignore", invalid="ignore"):
        steady = _steady(problem, columns, use, interval)
        price = _prices(problem, steady)
        net = (steady.value - steady.rate * (steady.use @ price)[:, None]).max(axis=1)
        rent = np.zeros(len(problem.streams))
        rent[steady.stream] = np.maximum(net, 0.0)
        worth = _worth(problem, columns, rent, interval)
        charge = _charge(problem, columns, use, price)
    if not (np.isfinite(worth).all() and np.isfinite(charge).all()):
        raise ProblemError("the utility beyond the window is not finite: scale or utility parameters are too large")
    return Beyond(worth, charge, price, rent)


def _steady(problem: Problem, columns: Floats, use: Floats, interval: Floats) -> _Steady:
    """Take the means over each stream's open messages."""
    opened = columns[:, 1] == 0
    of, t_gen, t_rcv = columns[opened, 0].astype(np.int64), columns[opened, 2], columns[opened, 4]
    age, apart = (t_rcv - t_gen)[:, None], interval[:, None] * INTERVALS
    area = _areas(problem, np.flatnonzero(opened), age, age + apart[of]) * columns[opened, 5][:, None]
    mean = _means(of, len(interval))
    stream = np.flatnonzero(mean.any(axis=1))
    apart = apart[stream]
    return _Steady(stream, (mean @ area)[stream] / apart, 1.0 / apart, (mean @ use[opened])[stream])


def _means(of: Ints, streams: int) -> Floats:
    """Return the matrix that takes the mean over the messages of each stream."""
    members = (np.arange(streams)[:, None] == of).astype(np.float64)
    count = np.maximum(members.sum(axis=1, keepdims=True), 1.0)
    return np.asarray(members / count)


def _intervals(problem: Problem, columns: Floats) -> Floats:
    """Return the mean time between the open messages of each stream [s].

    One that has a single message is taken to generate as rarely as the window allows.
    """
    opened = columns[columns[:, 1] == 0]
    of, t_gen = opened[:, 0].astype(np.int64), opened[:, 2]
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
    begin, rows = np.broadcast_to(begin, end.shape).ravel(), np.repeat(which, end.shape[1])
    return integrals([m.utility for m in problem.messages], rows, begin, end.ravel()).reshape(end.shape)


def _prices(problem: Problem, steady: _Steady) -> Floats:
    """Find the price of each constraint at which the streams use it up and no more.

    Sending more often earns less and less: going from one interval to the next shorter one buys `more` sends per
    second at `marginal` each. The channel is given away in the order of what is paid.
    """
    rate = np.concatenate((steady.rate, np.zeros((len(steady.rate), 1))), axis=1)
    value = np.concatenate((steady.value, np.zeros((len(steady.rate), 1))), axis=1)
    more = rate[:, :-1] - rate[:, 1:]
    marginal = np.maximum.accumulate((value[:, :-1] - value[:, 1:]) / more, axis=1)
    price = np.zeros(len(problem.constraints))
    for _ in range(SWEEPS if len(price) > 1 else 1):
        for k, constraint in enumerate(problem.constraints):
            price[k] = 0.0  # so that the others alone are charged
            users = steady.use[:, k] > 0
            paid = (marginal - (steady.use @ price)[:, None])[users] / steady.use[users, k, None]
            wanted = (more * steady.use[:, k, None])[users]
            price[k] = _clearing(paid.ravel(), wanted.ravel(), constraint.limit / constraint.window)
    return price


def _clearing(paid: Floats, wanted: Floats, offered: float) -> float:
    """Return the price at which of what is wanted no more than what is offered is bought; 0 when all fits."""
    order = np.argsort(-paid, kind="stable")
    bought = np.cumsum(wanted[order])
    last = int(np.searchsorted(bought, offered, side="right"))
    return max(float(paid[order[last]]), 0.0) if last < len(order) else 0.0


def _worth(problem: Problem, columns: Floats, rent: Floats, interval: Floats) -> Floats:
    """What each message is worth as the last of its stream, in place of what it is worth from t_c to t_end."""
    of, opened, t_gen, t_rcv = columns[:, 0].astype(np.int64), columns[:, 1] == 0, columns[:, 2], columns[:, 4]
    t_c = min(problem.t_end, float(t_rcv[opened].max()))
    coming = np.zeros(len(interval))  # when the first message after the window is received
    np.maximum.at(coming, of[opened], (t_rcv + interval[of])[opened])
    soonest = np.maximum(coming - t_c, 0.0)[of, None]
    later = interval[of, None] * np.concatenate((np.zeros(1), INTERVALS))
    begin = np.maximum(t_c - t_gen, 0.0)[:, None]
    end = np.concatenate((begin + soonest + later, np.maximum(problem.t_end - t_gen, 0.0)[:, None]), axis=1)
    area = _areas(problem, np.arange(len(of)), begin, np.maximum(end, begin)) * columns[:, 5][:, None]
    worth = (area[:, :-1] - rent[of, None] * later).max(axis=1) - area[:, -1]
    return np.where(t_rcv < problem.t_end, worth, 0.0)


def _charge(problem: Problem, columns: Floats, use: Floats, price: Floats) -> Floats:
    """What the windows after the last decision charge for a message."""
    sent, t_last = columns[:, 3], float(columns[columns[:, 1] == 0, 3].max())
    charge = np.zeros(len(sent))
    for k, constraint in enumerate(problem.constraints):
        if price[k] > 0 and constraint.limit > 0:
            share = np.minimum(use[:, k], constraint.limit)
            length = constraint.window * np.maximum(use[:, k] / constraint.limit, 1.0)
            charge += price[k] * share * np.maximum(sent + length - t_last, 0.0) / constraint.window
    return charge
