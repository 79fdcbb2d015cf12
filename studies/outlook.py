"""What is expected of a stream from what was seen of it so far: its rhythm, and the means of what it carries.

The rhythm is that of the daemon's core (`proxy.core.forecast`). Nothing here is known before it could be.
"""

from statistics import fmean
from typing import NamedTuple

import numpy as np

from planner import Constraint, Linear, Message
from planner.utility import Floats, MessageUtility
from proxy.core.forecast.rhythm import Rhythm
from proxy.core.forecast.schedule import Schedule

PRIOR = 1.0
"""What is taken for the period of a stream while nobody has generated twice [s]."""


class Outlook(NamedTuple):
    """What is expected after message `number` of a stream: more of `typical`, by a rhythm or at random moments.

    Without a `rhythm` they come every `period` on average [s]; it is 0.0 while only one message is known.
    """

    number: int
    typical: Message
    rhythm: Rhythm | None
    period: float

    @property
    def jitter(self) -> float:
        """Standard deviation of a generation time from what is expected [s]."""
        return 0.0 if self.rhythm is None else self.rhythm.jitter

    def supposing(self, period: float) -> "Outlook":
        """Return the outlook with a period for a stream of which one message is known; others stay as they are."""
        if self.period:
            return self
        rhythm = Rhythm(period, self.typical.t_gen, self.number, 0.0, 1)
        return self._replace(rhythm=rhythm, period=period)

    def means(self, now: float, most: int) -> Floats:
        """Return when the next `most` would come without jitter, or on average [s]; there is a period."""
        ahead = np.arange(1, most + 1)
        if self.rhythm is None:
            return np.asarray(now + self.period * ahead)
        return np.asarray(self.rhythm.due(self.number) + self.rhythm.period * ahead)

    def message(self, t_gen: float, use: tuple[float, ...] | None = None) -> Message:
        """Return the message expected at a time; one of typical use when nothing else is said."""
        m = self.typical
        t_sent = t_gen + (m.t_sent - m.t_gen)
        t_rcv = t_sent + (m.t_rcv - m.t_sent)
        return Message(m.stream, t_gen, t_sent, t_rcv, m.utility, m.scale, m.use if use is None else use)


class Watch:
    """Watches the messages of one stream go by, every one of them."""

    def __init__(self) -> None:
        self.number = 0
        """So many were seen."""
        self._schedule = Schedule()
        self._utilities: list[MessageUtility] = []
        self._uses: list[tuple[float, ...]] = []
        self._last: Message | None = None

    def observe(self, message: Message) -> None:
        """Take in the next message."""
        self.number += 1
        self._schedule.observe(self.number, message.t_gen)
        self._utilities.append(message.utility)
        self._uses.append(message.use)
        self._last = message

    def outlook(self) -> Outlook:
        """Return what is expected now; something was observed before."""
        if self._last is None:
            raise ValueError("nothing is expected of a stream before its first message")
        use = tuple(fmean(each) for each in zip(*self._uses, strict=True))
        typical = self._last._replace(utility=mean_utility(self._utilities), use=use)
        return Outlook(self.number, typical, self._schedule.rhythm, self._schedule.period)

    def uses(self) -> Floats:
        """Return what messages used so far, in ascending order of each constraint, one row a message."""
        return np.sort(np.array(self._uses), axis=0)


def supposed(outlooks: dict[int, Outlook]) -> dict[int, Outlook]:
    """Return outlooks that all have a period: one that is not known yet is taken for the mean of the others."""
    periods = [each.period for each in outlooks.values() if each.period]
    prior = fmean(periods) if periods else PRIOR
    return {stream: each.supposing(prior) for stream, each in outlooks.items()}


def interval_between_sends(outlooks: dict[int, Outlook], constraints: tuple[Constraint, ...]) -> float:
    """Return the mean time between two sends of a stream when the tightest constraint is used up [s].

    There are outlooks, and all of them have a period.
    """
    rates = {stream: 1.0 / each.period for stream, each in outlooks.items()}
    rate = sum(rates.values())
    limited = (
        len(rates) * sum(rates[s] * each.typical.use[k] for s, each in outlooks.items()) / rate * c.window / c.limit
        for k, c in enumerate(constraints)
        if c.limit > 0
    )
    return max([len(rates) / rate, *limited])


def mean_utility(utilities: list[MessageUtility]) -> MessageUtility:
    """Return the linear utility of mean slope; of other kinds the first."""
    linear = [utility for utility in utilities if isinstance(utility, Linear)]
    if len(linear) < len(utilities):
        return utilities[0]
    return Linear(fmean(u.u0 for u in linear), fmean(u.slope for u in linear))
