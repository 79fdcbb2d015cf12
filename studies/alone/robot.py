"""What one robot knows of a mission, and the window in which it decides its own messages.

It sees its own messages. Of others it knows what arrived, from when on it did: each message carries a `Told`. What was
lost it never knows of, so no two robots know the same. All clocks show the same time.
"""

from statistics import fmean
from typing import NamedTuple

import numpy as np

from planner import Message, Problem
from planner.utility import Floats
from studies.forecast import EARLY, expected_times, first_due
from studies.outlook import Outlook, Watch, interval_between_sends, supposed

FADE = 0.125
"""So much of the latency of a peer's next message is taken for its mean latency from now on."""


class Told(NamedTuple):
    """What a message carries for those who decide: itself, and what its robot expects of its stream by then.

    The message has `stream`, `t_gen`, `scale` (the weight), `use` (the size) and its utility; the outlook its number,
    the mean utility and size so far, and the rhythm as its robot found it: period, phase and jitter, which are five
    bytes of a daemon's digest. Its `t_rcv` is what its robot expects; who hears it knows better.
    """

    message: Message
    outlook: Outlook


class Robot:
    """One robot of a mission, with windows of `horizon` messages from the current one on.

    Of the mission it uses what is known beforehand: which robot has which stream, the constraints, and its end.
    """

    def __init__(self, mission: Problem, horizon: int) -> None:
        self._mission = mission
        self._horizon = horizon
        self._own: dict[int, Watch] = {}
        self._told: dict[int, Outlook] = {}
        self._latency: dict[int, float] = {}
        """By robot: how long its messages take to get here on average [s]."""
        self._facts: dict[tuple[int, float], Message] = {}
        """What was sent as far as known, by stream and generation time."""

    def generate(self, message: Message) -> Message:
        """A message of its own is there: take it in, and return it with the times that the robot expects of it."""
        here = message._replace(t_sent=message.t_gen, t_rcv=message.t_gen + self._mean_latency(), sent=False)
        self._own.setdefault(message.stream, Watch()).observe(here)
        return here

    def send(self, message: Message) -> Told:
        """A message of its own is sent: a fact from now on."""
        self._facts[message.stream, message.t_gen] = message._replace(sent=True)
        return Told(message, self._own[message.stream].outlook())

    def hear(self, told: Told, t: float) -> None:
        """A message of another robot arrives at `t` [s], perhaps not for the first time or late."""
        message, outlook = told
        place = message.stream, message.t_gen
        if place in self._facts:
            return
        self._facts[place] = message._replace(t_rcv=t, sent=True)
        robot, took = self._mission.streams[message.stream].robot, t - message.t_sent
        self._latency[robot] = took + (1.0 - FADE) * (self._latency.get(robot, took) - took)
        known = self._told.get(message.stream)
        if known is None or outlook.number > known.number:
            self._told[message.stream] = outlook

    def window(self, current: Message) -> Problem:
        """Return the window that decides a message of its own that is generated just now.

        It holds what was sent and still counts, what others may have sent but can not have been heard yet, the current
        message, and what is expected next.
        """
        now, outlooks = current.t_gen, self._outlooks()
        self._forget(now, outlooks)
        times = {stream: self._times(stream, outlook, now) for stream, outlook in outlooks.items()}
        flying = {stream: each[each <= now] for stream, each in times.items()}
        coming = {stream: each[each > now] for stream, each in times.items()}
        ahead = self._messages(coming, outlooks, self._horizon - 1)
        opened = [*self._messages(flying, outlooks, self._horizon), current, *ahead]
        messages = sorted([*self._facts.values(), *opened], key=self._order)
        complete, last = len(ahead) < self._horizon - 1, messages[-1].t_gen
        until = last + interval_between_sends(outlooks, self._mission.constraints)
        return Problem(
            self._mission.streams,
            tuple(messages),
            next(i for i, each in enumerate(messages) if each is current),
            self._mission.constraints,
            (),
            self._mission.t_start,
            self._mission.t_end if complete else min(self._mission.t_end, until),
            goes_on=not complete,
        )

    def _outlooks(self) -> dict[int, Outlook]:
        """Return what is expected of its own streams and of those heard of, which come when their robot's do."""
        told = {
            stream: outlook._replace(typical=m._replace(t_rcv=m.t_sent + self._latency[self._robot(stream)]))
            for stream, outlook in self._told.items()
            for m in [outlook.typical]
        }
        return supposed({**told, **{stream: watch.outlook() for stream, watch in self._own.items()}})

    def _times(self, stream: int, outlook: Outlook, now: float) -> Floats:
        """Return when messages of a stream are expected, those that others may have on the air included [s].

        A message of another robot that is sent and not heard yet was not generated earlier than now less its latency.
        One that should long be here was dropped or lost.
        """
        if stream in self._own or outlook.rhythm is None:
            return expected_times(outlook, now, self._horizon)
        lead, least = EARLY * outlook.jitter, now - self._latency[self._robot(stream)]
        past = max(0, int((least - lead - outlook.rhythm.due(outlook.number)) / outlook.period))
        due = outlook._replace(number=outlook.number + past).means(now, self._horizon + 1)
        return np.maximum(due[due > least - lead] - lead, least)

    def _messages(self, times: dict[int, Floats], outlooks: dict[int, Outlook], count: int) -> list[Message]:
        due = first_due(count, times, self._mission)
        return [outlooks[stream].message(t) for t, stream, _ in due]

    def _forget(self, now: float, outlooks: dict[int, Outlook]) -> None:
        """Forget what was sent so long ago that no constraint counts it, but for the last message of each stream."""
        used = [m.use for m in (*self._facts.values(), *(each.typical for each in outlooks.values()))]
        reach = max(
            (
                c.window * max(1.0, max(use[k] for use in used) / c.limit)
                for k, c in enumerate(self._mission.constraints)
                if c.limit > 0
            ),
            default=0.0,
        )
        last: dict[int, float] = {}
        for stream, t_gen in self._facts:
            last[stream] = max(t_gen, last.get(stream, t_gen))
        self._facts = {
            (stream, t_gen): m
            for (stream, t_gen), m in self._facts.items()
            if m.t_sent >= now - reach or t_gen == last[stream]
        }

    def _mean_latency(self) -> float:
        """Return how long its own messages take: as long as those of the others do; 0.0 before any was heard [s]."""
        return fmean(self._latency.values()) if self._latency else 0.0

    def _robot(self, stream: int) -> int:
        return self._mission.streams[stream].robot

    def _order(self, message: Message) -> tuple[float, int, int]:
        return message.t_gen, self._robot(message.stream), message.stream
