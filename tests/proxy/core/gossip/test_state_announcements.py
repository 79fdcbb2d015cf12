"""What a robot tells of itself."""

from dataclasses import replace

import pytest

from proxy.core.gossip.state_announcements import as_announced, differs, shortened, state_of, update_of
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import State, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.state_codec import pack_state, unpack_state
from proxy.core.protocol.tuning import TUNING
from proxy.core.view.stream import Generated
from proxy.core.view.view import SharedView

CAMERA = StreamState(1, "a", "camera", 0.5, 0.01, 1000, "periodic")
TOLD = State("r1", "z1", "enforce", "s", (CAMERA,), ("k",), number=4)


def test_streams_are_told_with_what_is_typical_of_them(make_specs):
    """Period and mean size, by which newcomers forecast at once."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs())
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    for count, size in ((1, 1000), (2, 2000)):
        stream.note_generated(count, Generated(0.5 * count, size, 1.0))
    (told,) = state_of(view, Mode.ENFORCE).streams
    assert told == StreamState(1, "robot/r1/camera", "camera", 0.5, size=1100, schedule="periodic")


@pytest.mark.parametrize(
    ("changes", "news"),
    [
        ({"period": 0.51}, False),
        ({"period": 0.6}, False),
        ({"jitter": 0.2}, False),
        ({"size": 1400}, False),
        ({"size": 3000}, True),
        ({"schedule": "poisson"}, True),
        ({"schedule": "bursts"}, True),
        ({"information_type": "video"}, True),
    ],
)
def test_estimates_are_news_when_they_moved(changes, news):
    """Then the update holds that stream alone. Of rhythms digests tell: only that there is none is news."""
    state = replace(TOLD, streams=(replace(CAMERA, **changes), replace(CAMERA, id=2)), number=5)
    assert differs(TOLD, replace(state, streams=state.streams[:1])) is news
    update = update_of(TOLD, state)
    assert (update.number, update.since) == (5, 4)
    assert [stream.id for stream in update.streams] == ([1, 2] if news else [2])


@pytest.mark.parametrize(("period", "news"), [(0.6, False), (0.9, False), (0.3, False), (0.2, True), (1.1, True)])
def test_of_random_times_only_large_changes_are_news(period, news):
    """The mean of a few dozen random gaps varies by itself."""
    told, now = (replace(TOLD, streams=(replace(CAMERA, schedule="poisson", period=p),)) for p in (0.5, period))
    assert differs(told, now) is news


@pytest.mark.parametrize(
    "changes", [{"mode": "shadow"}, {"subscriptions": ()}, {"streams": ()}, {"origins": ("x",)}, {"clock_error": 0.1}]
)
def test_other_changes_are_told_whole(changes):
    """They are rare."""
    state = replace(TOLD, **changes)
    assert differs(TOLD, state)
    assert update_of(TOLD, state) is None
    assert update_of(replace(TOLD, number=0), TOLD) is None


def test_a_state_has_the_sizes_that_were_told_unless_they_are_news():
    """Who asks for it knows of a stream what those know that heard the updates."""
    streams = (replace(CAMERA, size=1100, jitter=0.02), replace(CAMERA, id=2, size=900))
    after = as_announced(TOLD, replace(TOLD, streams=streams))
    assert [(s.size, s.jitter) for s in after.streams] == [(1000, 0.02), (900, 0.01)]
    grown = replace(TOLD, streams=(replace(CAMERA, size=3000),))
    assert as_announced(TOLD, grown) == grown


def test_what_is_too_much_is_left_out_and_counted():
    """By number, and by length."""
    many = tuple(replace(CAMERA, id=n) for n in range(5000))
    state = replace(TOLD, streams=many, subscriptions=("k",) * 2000, origins=("z",) * 300)
    short, left = shortened(state)
    assert (len(short.streams), len(short.subscriptions), len(short.origins)) == (4096, TUNING.subscriptions, 256)
    assert left == 904 + 976 + 44
    long = tuple(replace(CAMERA, id=n, key="k" * 1000) for n in range(400))
    short, left = shortened(replace(TOLD, streams=long, subscriptions=("k" * 1000,) * 100))
    assert (len(short.streams), len(short.subscriptions)) == (100, 50)
    assert shortened(TOLD) == (TOLD, 0)


@pytest.mark.full
@pytest.mark.parametrize("letter", ["k", "ä", "温", "🛰"])
@pytest.mark.parametrize("length", [1, 20, 250])
def test_as_much_is_told_as_others_read(letter, length):
    """Whatever the script: where letters were counted, not bytes, a state in Chinese was unreadable to all."""
    streams = tuple(
        StreamState(2**30 + n, letter * length, "c" * 64, 0.5, 1e-12, 2**30, "periodic") for n in range(4096)
    )
    subscriptions, origins = (letter * length,) * 1024, tuple(f"{n:032x}" for n in range(2**127, 2**127 + 256))
    report = SplitReport(2**32 - 1, None, 1, 2**32 - 1, (2**32 - 1,) * TUNING.turns)
    short, left = shortened(replace(TOLD, streams=streams, subscriptions=subscriptions, origins=origins))
    assert left == 4096 + 1024 - len(short.streams) - len(short.subscriptions)
    read = unpack_state(pack_state(replace(short, split=report)), "r1")
    assert read.subscriptions == short.subscriptions
    assert len(read.streams) == len(short.streams) > 50


@pytest.mark.parametrize("key", ["robot/*", "robot/**", "k" * 1025, "ä" * 513])
def test_what_others_do_not_read_is_left_out_and_spoils_nothing_else(key):
    """An application may publish on a key expression, or on a key of any length."""
    told = replace(TOLD, streams=(*TOLD.streams, replace(TOLD.streams[0], id=9, key=key)))
    short, left = shortened(told)
    assert (short, left) == (TOLD, 1)
    assert [each.key for each in unpack_state(pack_state(short), "r1").streams] == ["a"]


def test_subscriptions_that_others_do_not_read_are_left_out():
    """Too long ones only."""
    short, left = shortened(replace(TOLD, subscriptions=("a/*", "k" * 1025)))
    assert (short.subscriptions, left) == (("a/*",), 1)
