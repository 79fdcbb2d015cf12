"""The state of this robot: what is in it, what of it is news, and when the news is announced, or all of it."""

import math
from collections.abc import Iterable
from dataclasses import replace

from proxy.core.coordination.coordination import Coordination
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.gossip.account import Account
from proxy.core.gossip.announcements import Announcements
from proxy.core.gossip.digest_budget import StateBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface.commands import Command, Notice, SendState
from proxy.core.model.limits import fingerprint
from proxy.core.model.mode import Mode
from proxy.core.protocol import checked
from proxy.core.protocol.messages import State, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_state, stream_bytes
from proxy.core.protocol.tuning import TUNING as BOUNDS
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView

RHYTHMIC = {"", "periodic"}
"""Kinds of streams whose rhythm digests tell."""


def state_of(view: SharedView, mode: Mode) -> State:
    """Return the state of this robot as it is now, without a number."""
    settings = view.settings
    return State(
        robot=settings.robot,
        zid=settings.zid,
        mode=mode.value,
        specs=view.specs.generation,
        streams=tuple(_stream_state(stream) for stream in sorted(view.streams.own(), key=lambda s: s.id)),
        subscriptions=view.subscribers.own,
        wall_offset=view.clocks.offset,
        origins=tuple(view.origins.own),
        transport=settings.transport,
        clock_error=view.clocks.error,
        version=settings.version,
        limits=fingerprint(view.specs),
    )


def shortened(state: State) -> tuple[State, int]:
    """Return as much of a state as a message holds, without the latest streams, and how much that leaves out.

    And without keys that others do not read, one of which would spoil the whole state.
    """
    streams = tuple([s for s in state.streams if checked.is_key(s.key)])[: BOUNDS.streams]
    subscriptions = tuple([s for s in state.subscriptions if len(s.encode()) <= BOUNDS.key_bytes])[
        : BOUNDS.subscriptions
    ]
    while (taken := sum(map(_bytes, subscriptions))) > BOUNDS.subscription_bytes:
        subscriptions = subscriptions[: len(subscriptions) // 2]
    while sum(map(stream_bytes, streams)) > BOUNDS.state_bytes - BOUNDS.rest_bytes - taken:
        streams = streams[: len(streams) // 2]
    origins = state.origins[: BOUNDS.origins]
    left = len(state.streams) - len(streams) + len(state.subscriptions) - len(subscriptions)
    left += len(state.origins) - len(origins)
    return (replace(state, streams=streams, subscriptions=subscriptions, origins=origins), left) if left else (state, 0)


def _bytes(subscription: str) -> int:
    """Return what a subscription takes at most [B]: its length stands before it."""
    return len(subscription.encode()) + 3


def differs(announced: State, state: State) -> bool:
    """Whether a state is news. It is not if only rhythms changed that digests tell."""
    stepped = abs(state.wall_offset - announced.wall_offset) > TUNING.wall_clock_step
    return (
        stepped
        or bool(_news(announced, state))
        or _apart_from_streams(announced) != _apart_from_streams(state)
        or _lost(announced, state)
    )


def as_announced(announced: State, state: State) -> State:
    """Return a state with the sizes that were announced of streams without news: so all robots know the same."""
    news = {stream.id for stream in _news(announced, state)}
    sizes = {stream.id: stream.size for stream in announced.streams}
    return replace(state, streams=tuple(s if s.id in news else replace(s, size=sizes[s.id]) for s in state.streams))


def update_of(announced: State, state: State) -> State | None:
    """Return what is news of a state, if that is of its streams and its clock alone; None: all of it is announced."""
    if announced.number == 0 or _apart_from_streams(announced) != _apart_from_streams(state) or _lost(announced, state):
        return None
    streams, offset = _news(announced, state), state.wall_offset
    return State(
        state.robot, state.zid, "", "", streams, wall_offset=offset, number=state.number, since=announced.number
    )


def bare(state: State) -> State:
    """Return an update of a state by nothing."""
    return State(state.robot, state.zid, "", "", wall_offset=state.wall_offset, number=state.number, since=state.number)


def _news(announced: State, state: State) -> tuple[StreamState, ...]:
    before = {stream.id: stream for stream in announced.streams}
    return tuple(s for s in state.streams if s.id not in before or _moved(before[s.id], s))


def _moved(announced: StreamState, stream: StreamState) -> bool:
    if (announced.key, announced.information_type) != (stream.key, stream.information_type):
        return True
    if abs(stream.size - announced.size) > TUNING.size_change * max(stream.size, 1):
        return True
    if {announced.schedule, stream.schedule} <= RHYTHMIC:
        return False
    part = TUNING.random_period_change if stream.schedule == MEMORYLESS else TUNING.period_change
    change = max(abs(stream.jitter - announced.jitter), abs(stream.period - announced.period))
    return change > part * max(stream.period, announced.period, 1e-9) or announced.schedule != stream.schedule


def _lost(announced: State, state: State) -> bool:
    """Whether streams are gone."""
    return not {stream.id for stream in announced.streams} <= {stream.id for stream in state.streams}


def _apart_from_streams(state: State) -> Iterable[object]:
    return state.mode, state.specs, state.subscriptions, state.origins, state.clock_error


def _stream_state(stream: Stream) -> StreamState:
    schedule, size = stream.schedule, round(stream.sizes.mean)
    kind, period, jitter = schedule.kind, schedule.period, schedule.jitter
    return StreamState(stream.id, stream.key, stream.information_type.name, period, jitter, size, kind)


class StateAnnouncements:
    """The state that was announced last, and when the next one may follow it."""

    def __init__(
        self,
        now: float,
        view: SharedView,
        coordination: Coordination,
        *,
        account: Account,
        budget: StateBudget,
        announcements: Announcements,
    ) -> None:
        self._view = view
        self._coordination = coordination
        self._account = account
        self._budget = budget
        self._announcements = announcements
        self.state = State(view.settings.robot, view.settings.zid, "", "")
        """The one that was announced last; number 0: none."""
        self.left_out = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self._announced_at = self._reviewed_at = now - TUNING.states_apart
        self._review_at = now
        """When to look whether our state is news."""
        self._large_is_new = False
        """Whether a stream that others plan with is news."""
        self._subscriptions_are_new = False
        """Whether what our apps subscribe to is."""

    def review(self, at: float) -> None:
        """Our state may be news; look then [s]."""
        self._review_at = min(self._review_at, at)

    def subscribed(self, now: float) -> None:
        """Our apps subscribe to other keys: told at once, as nobody plans for streams that nobody wants."""
        self._subscriptions_are_new = True
        self.review(now)

    def sample_came(self, now: float, size: int, *, new: bool) -> None:
        """A stream of ours, which may be `new`, has a sample; look at once where others plan with what is new."""
        large = new and self._announcements.changes_plans(size)
        self._large_is_new |= large
        every = 0.0 if new else TUNING.review_every
        self.review(now if large else max(now + TUNING.gather, self._reviewed_at + every))

    def clock_set(self, now: float, offset: float, error: float) -> None:
        """Our wall clock is so much ahead of the monotonic one, and wrong by `error` at most [s]."""
        stepped = abs(offset - self.state.wall_offset) > TUNING.wall_clock_step
        if stepped or error != self._view.clocks.error:
            self.review(now)

    def asked(self, now: float) -> None:
        """Somebody asked for our state and got it."""
        self._account.sent_other(now, len(pack_state(self.state)), 1)

    def tell_parts(self, report: SplitReport, *, splits: bool) -> SendState:
        """Return our state with this report on parts, as an update of its number; the bid only if it is news."""
        before, self.state = self.state, replace(self.state, splits=splits, split=report)
        told = report
        if before.split is not None and before.split.version == report.version:
            told = replace(report, bid=None)
        return SendState(self.state, replace(bare(self.state), splits=splits, split=told))

    def due_at(self, now: float) -> float:
        """When a state may have to go out at the latest [s]."""
        return max(self._review_at, self._allowed_at(now))

    def advance(self, now: float, mode: Mode) -> list[Command]:
        """Announce what is new, if it is time to; `mode` is ours."""
        return self._announce(now, mode) if now >= self.due_at(now) else []

    def _allowed_at(self, now: float) -> float:
        """When a state may follow the last one [s]: once that is paid for; sooner what others plan with."""
        owed, ahead = self._budget.paid_in, self._large_is_new
        if self._subscriptions_are_new:
            ahead |= owed <= self._budget.takes(len(pack_state(self.state)), self._account.copies)
        ahead = ahead and not self._coordination.team.large
        takes = self._budget.takes(TUNING.state_update, self._account.copies)
        apart = max(TUNING.states_apart, min(TUNING.longest_apart, TUNING.states_part * takes))
        return max(self._announced_at + apart, now if ahead else now + owed)

    def _announce(self, now: float, mode: Mode) -> list[Command]:
        self._review_at, self._reviewed_at = math.inf, now
        self._large_is_new = self._subscriptions_are_new = False
        state, left_out = shortened(state_of(self._view, mode))
        if self.state.number and not differs(self.state, state):
            return []
        state = replace(as_announced(self.state, state), number=self.state.number + 1)
        state = replace(state, splits=self.state.splits, split=self.state.split)
        update = update_of(self.state, state)
        if update is not None and (until := self._announced_at + self._takes(update)) > now:
            self._review_at = until
            return []
        notices: list[Command] = []
        if left_out > self.left_out:
            text = f"{left_out} streams, subscriptions or origins are too many to tell the others"
            notices.append(Notice("warning", text, {"reason": "untold"}))
        self.left_out, self.state, self._announced_at = left_out, state, now
        for each in state.streams:
            if (stream := self._view.streams.known(state.robot, each.key)) is not None:
                stream.sizes.announce(each.size)
        self._account.sent_other(now, len(pack_state(update or state)), self._account.copies)
        return [*notices, SendState(state, update)]

    def _takes(self, update: State) -> float:
        """Return how long news of our streams waits [s]: where a large team has equal parts nobody plans with it."""
        if not self._coordination.team.quiet:
            return 0.0
        return self._budget.takes(len(pack_state(update)), self._account.copies)
