"""Which streams there are, and who has to leave."""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner import Video
from proxy.core.interface.events import SampleHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.view.stream import Generated
from proxy.core.view.streams import Streams, owner_of
from proxy.core.view.tuning import TUNING

CAMERA = "robot/r2/camera"


@pytest.fixture
def specs(make_specs):
    return make_specs()


def table(specs, most):
    return Streams(CoreSettings("r1", "z-r1", streams=most), specs)


def test_streams_are_bounded(specs):
    """The one not heard of for longest is forgotten, and counted."""
    streams = table(specs, 3)
    for number in range(5):
        streams.touch(float(number), "r1", f"robot/{number}/camera")
    assert [stream.key for stream in streams] == [f"robot/{number}/camera" for number in (2, 3, 4)]
    assert streams.evicted == 2


def test_only_who_hears_of_a_stream_keeps_it(specs):
    """To look whether it is known makes no stream, and keeps none from being forgotten."""
    streams = table(specs, 2)
    assert streams.known("r1", "robot/1/camera") is None
    first, second = (streams.touch(0.0, "r1", f"robot/{number}/camera") for number in (1, 2))
    assert streams.known("r1", first.key) is streams.touch(1.0, "r1", first.key) is first
    assert (first.known_until, list(streams)) == (1.0, [first, second])
    assert streams.known("r1", second.key) is second
    streams.touch(2.0, "r1", "robot/3/camera")
    assert streams.known("r1", second.key) is None


def test_who_has_most_streams_loses_one(specs):
    """A robot, or all plain nodes together, cannot push out others' streams or our own."""
    streams = table(specs, 6)
    for robot in ("r1", "r2"):
        for key in ("a", "b"):
            streams.touch(0.0, robot, f"robot/{key}/camera")
    for number in range(20):
        streams.touch(1.0, f"?{number}" if number % 2 else "r9", f"robot/{number}/camera")
    robots = [stream.robot for stream in streams]
    assert (robots.count("r1"), robots.count("r2")) == (2, 2)
    assert sum(robot.startswith("?") for robot in robots) == 1
    assert streams.evicted == 18


def test_a_single_stream_of_each_owner_is_full_too(specs):
    """The newcomer stays; another owner's leaves."""
    streams = table(specs, 2)
    for robot in ("r1", "r2", "r3"):
        streams.touch(0.0, robot, CAMERA)
    assert {stream.robot for stream in streams} == {"r1", "r3"}


def test_what_matches_is_bounded(specs, monkeypatch):
    """The oldest is forgotten, and counted."""
    monkeypatch.setattr("proxy.core.view.streams.TUNING", replace(TUNING, matching_keys=2))
    streams = table(specs, 10)
    for number in range(3):
        streams.match(f"robot/{number}/camera", matching=True)
    assert streams.evicted == 1
    assert [streams.touch(0.0, "r1", f"robot/{n}/camera").matching for n in range(3)] == [False, True, True]


def test_a_key_that_nobody_plans_for_is_no_stream(specs):
    """It takes no room."""
    streams = table(specs, 2)
    assert streams.touch(0.0, "r1", "other/key") is None
    assert (list(streams), streams.revision) == ([], 0)


def test_a_robot_takes_over_what_was_heard_of_a_plain_node(specs):
    """Unless it has the stream already: then its own stays."""
    streams = table(specs, 4)
    plain = [streams.touch(0.0, f"?{origin}", CAMERA) for origin in ("one", "other")]
    plain[0].note_generated(3, Generated(0.0, 10, 1.0))
    for stream in plain:
        streams.hand_over(stream, "r2")
    (heir,) = streams
    assert (heir.robot, heir.newest.size, heir.generated) == ("r2", 10, 0)


def test_streams_follow_the_name_of_their_robot(specs):
    """Nobody else's do."""
    streams = table(specs, 4)
    for robot in ("r2", "r3"):
        streams.touch(0.0, robot, CAMERA)
    streams.rename("r2", "r4")
    assert {stream.robot for stream in streams} == {"r3", "r4"}
    assert [stream.robot for stream in streams.of("r4")] == ["r4"]
    assert streams.known("r2", CAMERA) is None


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from(["r1", "r2", "?a", "?b"]), st.integers(0, 5)), max_size=40))
def test_every_stream_has_one_owner_and_changes_are_counted(make_specs, looked_at):
    """Whatever is asked for, in whatever order, both tables hold the same."""
    streams = table(make_specs(), 4)
    before = 0
    for now, (robot, number) in enumerate(looked_at):
        known = streams.known(robot, f"robot/{number}/camera")
        found = streams.touch(float(now), robot, f"robot/{number}/camera")
        assert (known is None) == (streams.revision > before)
        assert found is streams.known(robot, found.key)
        before = streams.revision
    everybody = {owner_of(stream.robot) for stream in streams}
    listed = [stream for owner in everybody - {"?"} for stream in streams.of(owner)] + streams.plain()
    assert {id(stream) for stream in listed} == {id(stream) for stream in streams}
    assert len(list(streams)) <= 4


def test_specs_are_swapped_whole(view, make_specs):
    """Streams keep what was observed under their new type, or leave."""
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.note_generated(1, Generated(0.0, 10, 1.0))
    view.streams.set_specs(make_specs(limit="1 Mbit/s"))
    assert next(iter(view.streams)).generated == 1
    assert next(iter(view.streams)).information_type.utility == Video()
    text = '[[information_type]]\nname = "x"\nkeys = ["x"]\naggregation = "most_recent"\nutility = { kind = "video" }\n'
    view.streams.set_specs(make_specs(text=text))
    assert list(view.streams) == []


def test_matching_outlives_its_stream(view, make_specs):
    """Zenoh says it once: neither a swap of specs nor an eviction may lose it, nor may it come too early."""
    key = "robot/r1/camera"
    view.streams.match(key, matching=True)
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 1
    view.streams.set_specs(make_specs(text='[[information_type]]\nname="x"\nkeys=["x"]\nutility={kind="video"}\n'))
    view.streams.set_specs(make_specs())
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 1
    view.streams.match(key, matching=False)
    assert view.subscribers.count(view.streams.touch(0.0, "r1", key)) == 0


def test_plain_nodes_that_fall_silent_are_forgotten(view):
    """After a minute, or a few periods."""
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "feed", None, None))
    view.sweep(30.0)
    assert len(list(view.streams)) == 1
    view.sweep(35.0)
    view.sweep(62.0)
    assert list(view.streams) == []
