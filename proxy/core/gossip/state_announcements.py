"""What a robot tells of itself: its state, what is news of it, and how much of it can be told."""

from collections.abc import Iterable
from dataclasses import replace

from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.model.limits import fingerprint
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import MOST_ORIGINS, MOST_SUBSCRIPTIONS, MOST_TEXT, MOST_TOLD, State, StreamState
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView

LEAST_CHANGE = 0.1
"""Periods are estimates: only one that moved by this part of the longer one is news..."""
AT_RANDOM = 0.5
"""... and by this part of it where samples come at random: what 32 of them show varies by a sixth without any news,
what the first few show by a half. Five such robots told 122 % of what they may with a tenth, and the alarms of eight
robots with cameras took a tenth of the allowance with three tenths."""
LEAST_GROWTH = 0.5
"""So are sizes, which every digest tells anew."""
RHYTHMIC = {"", "periodic"}
"""Of streams that generate so, digests tell the rhythm."""
WALL_STEP = 1e-3
"""A wall clock that moved by more than this is told anew [s]."""


def state_of(view: SharedView, mode: Mode) -> State:
    """Return the state of this robot as it is now, without a number."""
    settings = view.settings
    return State(
        robot=settings.robot,
        zid=settings.zid,
        mode=mode.value,
        specs=view.specs.generation,
        streams=tuple(_stream_state(stream) for stream in sorted(view.own(), key=lambda s: s.id)),
        subscriptions=view.interest,
        wall_offset=view.wall_offset,
        origins=tuple(view.origins),
        transport=settings.transport,
        clock_error=view.clock_error,
        version=settings.version,
        limits=fingerprint(view.specs),
    )


def shortened(state: State) -> tuple[State, int]:
    """Return as much of a state as can be told, the latest streams left out first, and how much that leaves out."""
    streams = state.streams[:MOST_TOLD]
    while sum(len(s.key) + len(s.information_type) + len(s.schedule) for s in streams) > MOST_TEXT:
        streams = streams[: len(streams) // 2]
    subscriptions = state.subscriptions[:MOST_SUBSCRIPTIONS]
    while sum(map(len, subscriptions)) > MOST_TEXT // 2:
        subscriptions = subscriptions[: len(subscriptions) // 2]
    origins = state.origins[:MOST_ORIGINS]
    left = len(state.streams) - len(streams) + len(state.subscriptions) - len(subscriptions)
    left += len(state.origins) - len(origins)
    return (replace(state, streams=streams, subscriptions=subscriptions, origins=origins), left) if left else (state, 0)


def differs(told: State, state: State) -> bool:
    """Whether a state is news; not where only rhythms changed, of which digests tell."""
    stepped = abs(state.wall_offset - told.wall_offset) > WALL_STEP
    return (
        stepped
        or bool(_news(told, state))
        or _apart_from_streams(told) != _apart_from_streams(state)
        or _lost(told, state)
    )


def as_told(told: State, state: State) -> State:
    """Return a state with the sizes told of streams of which nothing is news: who hears it all knows what others do."""
    news, sizes = {stream.id for stream in _news(told, state)}, {stream.id: stream.size for stream in told.streams}
    return replace(state, streams=tuple(s if s.id in news else replace(s, size=sizes[s.id]) for s in state.streams))


def update_of(told: State, state: State) -> State | None:
    """Return what is news of a state, if that is of its streams and its clock alone; None: all of it must be told."""
    if told.number == 0 or _apart_from_streams(told) != _apart_from_streams(state) or _lost(told, state):
        return None
    news = _news(told, state)
    return State(state.robot, state.zid, "", "", news, (), state.wall_offset, number=state.number, since=told.number)


def _news(told: State, state: State) -> tuple[StreamState, ...]:
    before = {stream.id: stream for stream in told.streams}
    return tuple(s for s in state.streams if s.id not in before or _moved(before[s.id], s))


def _moved(told: StreamState, stream: StreamState) -> bool:
    if (told.key, told.information_type) != (stream.key, stream.information_type):
        return True
    if abs(stream.size - told.size) > LEAST_GROWTH * max(stream.size, 1):
        return True
    if {told.schedule, stream.schedule} <= RHYTHMIC:
        return False
    part, longer = AT_RANDOM if stream.schedule == MEMORYLESS else LEAST_CHANGE, max(stream.period, told.period)
    moved = max(abs(stream.jitter - told.jitter), abs(stream.period - told.period)) > part * max(longer, 1e-9)
    return moved or told.schedule != stream.schedule


def _lost(told: State, state: State) -> bool:
    """Whether streams are gone."""
    return not {stream.id for stream in told.streams} <= {stream.id for stream in state.streams}


def _apart_from_streams(state: State) -> Iterable[object]:
    return state.mode, state.specs, state.subscriptions, state.origins, state.clock_error


def _stream_state(stream: Stream) -> StreamState:
    schedule, size = stream.schedule, round(stream.mean_size)
    kind, period, jitter = schedule.kind, schedule.period, schedule.jitter
    return StreamState(stream.id, stream.key, stream.information_type.name, period, jitter, size, kind)
