"""The state of this robot: what is in it, what of it is news, and how much of it can be announced."""

from collections.abc import Iterable
from dataclasses import replace

from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.gossip.tuning import TUNING
from proxy.core.model.limits import fingerprint
from proxy.core.model.mode import Mode
from proxy.core.protocol import checked
from proxy.core.protocol.messages import State, StreamState
from proxy.core.protocol.state_codec import stream_bytes
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
    subscriptions = tuple(filter(_is_readable, state.subscriptions))[: BOUNDS.subscriptions]
    while (taken := sum(map(_bytes, subscriptions))) > BOUNDS.subscription_bytes:
        subscriptions = subscriptions[: len(subscriptions) // 2]
    while sum(map(stream_bytes, streams)) > BOUNDS.state_bytes - BOUNDS.rest_bytes - taken:
        streams = streams[: len(streams) // 2]
    origins = state.origins[: BOUNDS.origins]
    left = len(state.streams) - len(streams) + len(state.subscriptions) - len(subscriptions)
    left += len(state.origins) - len(origins)
    return (replace(state, streams=streams, subscriptions=subscriptions, origins=origins), left) if left else (state, 0)


def _is_readable(text: str) -> bool:
    """Whether others take an expression that is so long."""
    return len(text.encode()) <= BOUNDS.key_bytes


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
