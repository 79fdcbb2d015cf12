"""The planning window: which messages a decision looks at, and what they would use.

It ends at the earlier of `horizon` messages and `horizon_time`, but not before now + 2·max(T) and not before one
forecast message of every stream; if that is too many, low-value streams are thinned, not time. Only streams that
somebody wants compete, and where robots hold shares only our own, because then no other stream can gain by what we
leave. Sent messages are facts: the last one of a stream as a message, for what it is still worth, and everything
sent within a constraint window as traffic, for what it uses.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from planner import Message, Problem, Traffic
from planner import Stream as PlannerStream
from proxy.core.inbox import Waiting
from proxy.core.limits import Limits, use_of
from proxy.core.stream import Stream
from proxy.core.view import SharedView

LEAST_LIFE = 1e-3
"""The last message of a window lives at least this long [s]."""


@dataclass(slots=True)
class _Candidate:
    """A stream that competes, and when it is expected to generate; `place` is its number in the problem."""

    stream: Stream
    place: int
    copies: int
    receivers: int
    latency: float
    times: list[float]

    @property
    def worth(self) -> float:
        """Value per byte on the air, for all forecasts together that are still there."""
        last = self.stream.newest
        return last.scale * self.receivers / max(last.size * self.copies, 1) / len(self.times)


@dataclass(frozen=True, slots=True)
class _Open:
    """A message to decide."""

    t_gen: float
    of: _Candidate
    size: int
    scale: float
    features: Mapping[str, float]
    current: bool = False


class WindowBuilder:
    """Builds the problem of one decision from the shared view."""

    def __init__(self, view: SharedView, started: float) -> None:
        self._view = view
        self._started = started

    def build(self, now: float, current: Waiting, waiting: Iterable[Waiting], limits: Limits) -> Problem:
        """Return the problem of deciding `current` while others of our own samples are `waiting`."""
        candidates = self._candidates(now, current.key, only_own=bool(limits.held))
        end = self._forecast(now, candidates, limits)
        for candidate in candidates:
            candidate.times = [t for t in candidate.times if t <= end]
        _thin(candidates, self._view.settings.horizon)
        ours = {c.stream.key: c for c in candidates if c.stream.robot == self._view.settings.robot}
        opened = [
            _Open(w.t_gen, c, w.size, w.scale * c.receivers, w.features, w is current)
            for w in (*waiting, current)
            if (c := ours.get(w.key)) is not None
        ]
        opened += [
            _Open(t, c, last.size, last.scale * c.receivers, last.features)
            for c in candidates
            for last in (c.stream.newest,)
            for t in c.times
        ]
        opened.sort(key=lambda m: (m.t_gen, m.of.place))
        return self._problem(now, candidates, opened, limits)

    def _candidates(self, now: float, deciding: str, *, only_own: bool) -> list[_Candidate]:
        """Streams that compete, by robot and key; that of the current message always does."""
        view, own = self._view, self._view.settings.robot
        competing = sorted(
            (
                s
                for s in view.streams()
                if (s.robot == own and s.key == deciding)
                or ((s.robot == own or not only_own) and view.competes(now, s))
            ),
            key=lambda s: (s.robot, s.key),
        )
        return [
            _Candidate(s, place, view.copies(s), max(1, view.receivers(s)), view.latency(s.robot), [])
            for place, s in enumerate(competing)
        ]

    def _forecast(self, now: float, candidates: list[_Candidate], limits: Limits) -> float:
        """Fill in the expected generation times of every candidate; return the end of the window.

        Others' messages since we last heard of them have an unknown fate: they are decisions too.
        """
        settings = self._view.settings
        longest = max(c.window for c in limits.union)
        for c in candidates:
            heard = c.stream.schedule.last or now
            after = now if c.stream.robot == settings.robot else max(heard, now - longest)
            c.times = c.stream.schedule.forecast(after, now + settings.horizon_time, settings.horizon)
        ordered = sorted(t for c in candidates for t in c.times)
        end = ordered[settings.horizon - 1] if len(ordered) >= settings.horizon else now + settings.horizon_time
        return max([end, now + 2.0 * longest, *(c.times[0] for c in candidates if c.times)])

    def _problem(self, now: float, candidates: list[_Candidate], opened: list[_Open], limits: Limits) -> Problem:
        constraints = (*limits.union, *limits.held)
        messages = [(fact, False) for c in candidates if (fact := _fact(c, len(constraints))) is not None]
        t_sent = 0.0
        for m in opened:
            own = m.of.stream.robot == self._view.settings.robot
            t_sent = max(t_sent, m.t_gen, now if own else 0.0)
            use = use_of(m.size, m.of.copies, limits.union, own=own)
            held = use if own else (0.0,) * len(use)
            messages.append((_message(m, t_sent, (*use, *held[: len(limits.held)])), m.current))
        robots = sorted({c.stream.robot for c in candidates})
        messages.sort(key=lambda entry: (entry[0].t_gen, entry[0].stream))
        return Problem(
            streams=tuple(PlannerStream(robots.index(c.stream.robot)) for c in candidates),
            messages=tuple(message for message, _ in messages),
            current=next(i for i, (_, is_current) in enumerate(messages) if is_current),
            constraints=constraints,
            traffic=self._traffic(now, candidates, limits),
            t_start=min(self._started, messages[0][0].t_gen),
            t_end=t_sent + opened[-1].of.latency + max(opened[-1].of.stream.mean_interval, LEAST_LIFE),
        )

    def _traffic(self, now: float, candidates: list[_Candidate], limits: Limits) -> tuple[Traffic, ...]:
        """Return everything known to be sent that the windows still count."""
        longest = max(c.window for c in limits.union)
        nothing = (0.0,) * len(limits.held)
        traffic = [
            Traffic(s.t_sent, (*use_of(s.size, c.copies, limits.union, own=False), *nothing))
            for c in candidates
            if c.stream.robot != self._view.settings.robot
            for s in c.stream.recent
            if now >= s.t_sent >= now - longest
        ]
        traffic += [Traffic(t, (*use, *use[: len(limits.held)])) for t, use in limits.sent]
        return tuple(sorted(traffic, key=lambda sent: sent.t_sent))


def _message(m: _Open, t_sent: float, use: tuple[float, ...]) -> Message:
    utility = m.of.stream.information_type.utility_of(m.features)
    return Message(m.of.place, m.t_gen, t_sent, t_sent + m.of.latency, utility, m.scale, use)


def _fact(c: _Candidate, constraints: int) -> Message | None:
    """Return the last sent message of a stream, for what it is still worth; its use counts as traffic."""
    sent = c.stream.sent
    if sent is None:
        return None
    utility, nothing = c.stream.information_type.utility_of(sent.features), (0.0,) * constraints
    t_rcv, scale = sent.t_sent + c.latency, sent.scale * c.receivers
    return Message(c.place, sent.t_gen, sent.t_sent, t_rcv, utility, scale, nothing, sent=True)


def _thin(candidates: list[_Candidate], horizon: int) -> None:
    """Halve the forecasts that are worth least each until the window holds at most `horizon`."""
    excess = sum(len(c.times) for c in candidates) - horizon
    while excess > 0:
        thickest = min((c for c in candidates if len(c.times) > 1), key=lambda c: c.worth, default=None)
        if thickest is None:
            return
        kept = thickest.times[::2]
        excess -= len(thickest.times) - len(kept)
        thickest.times = kept
