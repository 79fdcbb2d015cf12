"""The planning window: which messages a decision looks at, and what they would use.

It holds contested messages alone (`disputes.py`); the others are booked. It reaches `planned_windows` of the longest
constraint window, at most `horizon_time`, and at least to one forecast message of every stream; beyond `horizon`
messages less far, and then it is thinned. Only streams that somebody wants compete, within a part of ours only our own;
of too many half of the places are for those worth most per byte on the air, half for those that generate next. What was
sent and guarantees demand are facts where they matter to their streams, and traffic for what they use.
"""

import math
from bisect import insort
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from operator import itemgetter
from typing import NamedTuple

from planner import Problem
from proxy.core.market.disputes import Disputes
from proxy.core.model.limits import Limits, stretched
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Stream, at_stake
from proxy.core.view.view import SharedView
from proxy.core.window.forecast import Candidate, forecast, guaranteed, reach, thin
from proxy.core.window.problem import Contents, OpenMessage, expected, problem, published
from proxy.core.window.tuning import TUNING


class WindowSize:
    """The `messages` that a window may hold besides the current one, for decisions within a `deadline` [s]."""

    def __init__(self, deadline: float) -> None:
        self._deadline = deadline
        self.messages = max(TUNING.fewest_messages, TUNING.overhead * deadline / TUNING.seconds_per_message)
        self._overruns: list[float] = []
        """By how much the last decisions in a row took too long: what of their time was allowed."""

    def note(self, held: int, overhead: float, *, thinned: bool) -> None:
        """A decision took so long besides its search [s], on a window that held so many messages."""
        fitting = TUNING.overhead * self._deadline / max(overhead, 1e-9)
        if fitting >= 1.0:
            self._overruns.clear()
            self.messages *= min(fitting, TUNING.growing) if thinned else 1.0
            return
        self._overruns = [*self._overruns, fitting][-TUNING.overruns :]
        if len(self._overruns) == TUNING.overruns:
            part = max(*self._overruns, TUNING.shrinking)
            self.messages = max(TUNING.fewest_messages, math.floor(min(held, self.messages) * part))


class Window(NamedTuple):
    """The `problem` of a decision, which has `held` messages to decide besides the current one, and `full` of itself.

    The `candidates` are its streams, in order.
    """

    problem: Problem
    held: int
    full: int
    candidates: list[Candidate]


class WindowBuilder:
    """Builds the problem of one decision from the shared view."""

    def __init__(self, view: SharedView, started: float) -> None:
        self._view = view
        self._started = started
        self.disputes = Disputes(view)

    def build(
        self, now: float, current: Waiting, waiting: Iterable[Waiting], limits: Limits, most: float = math.inf
    ) -> Window:
        """Return the problem of deciding `current` beside `most` others, half of them `waiting`, then forecasts."""
        waiting, limits, horizon = list(waiting), self._contested(now, limits), self._view.settings.horizon
        queued = int(min(len(waiting), most // 2))
        places = int(min(horizon, most - queued))
        candidates = self._candidates(now, current, limits, places)
        demanded, coming = self._forecast(now, candidates, current, limits, places)
        full = len(waiting) + min(horizon, coming - len(demanded))
        thin(candidates, places)
        ours = {c.stream.key: c for c in candidates if c.own}
        opened = [published(now, w, ours[w.key], limits) for w in _competing(waiting, ours)[:queued]]
        if current.to:
            candidates.append(self._copied(now, len(candidates), current))
        this = candidates[-1] if current.to else ours[current.key]
        opened.append(published(now, current, this, limits, current=True))
        for c in candidates:
            opened += expected(now, c, c.times, limits)
        opened.sort(key=itemgetter(0, 1))
        made = problem(now, self._started, Contents(candidates, opened, demanded), limits)
        return Window(made, len(opened) - 1, full, candidates)

    def _contested(self, now: float, limits: Limits) -> Limits:
        """Return what is left of the limits to what is contested, without the sends that are booked."""
        disputes = self.disputes
        disputes.advance(now, limits.union, alone=limits.alone, turns=limits.turns)
        union = tuple(
            replace(c, limit=max(left, TUNING.contested_at_least * c.limit), window=window)
            for c, left, window in zip(limits.union, *disputes.left(now), strict=True)
        )
        union = stretched(union, limits.windows)
        sent, others = disputes.unbooked(now, limits.sent, own=True), disputes.unbooked(now, limits.others, own=False)
        return replace(limits, union=union, sent=sent, others=others)

    def _candidates(self, now: float, deciding: Waiting, limits: Limits, most: int) -> list[Candidate]:
        """Streams that compete, by robot and key, at most so many; that of the current message always does."""
        view, own = self._view, self._view.settings.robot
        competing = view.contention.chosen(now, most, own if limits.alone else None, self.disputes.settled)
        current = None if deciding.to else view.streams.known(own, deciding.key)
        if current is not None and current not in competing:
            insort(competing, current, key=lambda s: (s.robot, s.key))
        return [self._candidate(now, place, stream) for place, stream in enumerate(competing)]

    def _candidate(self, now: float, place: int, stream: Stream) -> Candidate:
        view, own = self._view, stream.robot == self._view.settings.robot
        markovian, audience = stream.information_type.markovian, view.audiences.of(now, stream)
        size = stream.sizes.likely(stream.newest.size)
        return Candidate(stream, place, view.subscribers.copies(stream), audience, own, markovian, size)

    def _copied(self, now: float, place: int, current: Waiting) -> Candidate:
        """Return the stream of a copy, as it is for the one robot that the copy is for."""
        view, own = self._view, self._view.settings.robot
        stream = view.streams.touch(now, own, current.key)
        if stream is None:
            raise LookupError(f"no type plans for {current.key}")
        audience = view.audiences.to(current.to, current.size)
        return Candidate(stream, place, 1 + view.settings.relayed, audience, own=True, markovian=False, copy=True)

    def _forecast(
        self, now: float, candidates: list[Candidate], current: Waiting, limits: Limits, most: int
    ) -> tuple[list[OpenMessage], int]:
        """Fill in when candidates are expected to generate; return what guarantees demand, and how much would come."""
        stream = self._view.streams.known(self._view.settings.robot, current.key)
        forecast(now, self._view, candidates, limits, stream)
        coming = sum([len(c.times) for c in candidates])
        end = reach(now, candidates, limits, most)
        demanded = [m for c in candidates if guaranteed(c.stream) for m in expected(now, c, c.take_owed(), limits)]
        for c in candidates:
            c.bound(end)
        return demanded, coming


def _competing(waiting: Iterable[Waiting], ours: Mapping[str, Candidate]) -> list[Waiting]:
    """Return the samples that are weighed beside the current one; of a model of the operator's the most valuable."""
    chosen: list[Waiting] = []
    count: Counter[str] = Counter()
    for w in sorted(waiting, key=lambda w: (-_at_stake(w, ours.get(w.key)), w.t_gen, w.sample)):
        of = ours.get(w.key)
        count[w.key] += 1
        if of is not None and (of.standard or count[w.key] <= TUNING.messages_of_a_model):
            chosen.append(w)
    return chosen


def _at_stake(waiting: Waiting, of: Candidate | None) -> float:
    return waiting.scale if of is None else at_stake(of.stream, waiting.scale)
