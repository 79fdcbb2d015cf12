"""Whose samples are whose."""

import pytest

from proxy.core.interface.events import SampleHeard
from proxy.core.protocol.messages import State, StreamDigest
from tests.proxy.core.view.met import CAMERA, digest, meet


def test_an_origin_belongs_to_the_robot_whose_app_side_it_entered(view):
    """Apps that stamp carry their own ids; what another robot claims is never ours."""
    meet(view, origins=("app-2",))
    assert view.origins.robot_of(None) == view.origins.robot_of("z-r1") == "r1"
    assert view.origins.robot_of("app-2") == view.origins.robot_of("z-r2") == "r2"
    assert view.origins.robot_of("app-1") == "?app-1"
    assert view.origins.claim("app-1")
    assert not view.origins.claim("app-1")
    assert not view.origins.claim("app-2")
    assert view.origins.robot_of("app-1") == "r1"


def test_origins_are_bounded(view):
    """The oldest claim is forgotten, never our own id."""
    for number in range(300):
        view.origins.claim(f"app-{number}")
    assert len(view.origins.own) == 256
    assert view.origins.robot_of("z-r1") == "r1"
    assert view.evicted == 300 - 255


def test_an_origin_claimed_later_moves_its_streams_to_the_robot(view):
    """What was overheard of them stays known; what the robot has already is not taken twice."""
    for now in (0.0, 0.5, 1.0, 1.5, 2.0):
        view.overhearing.take(SampleHeard(now, CAMERA, 100, "feed", None, None))
        view.overhearing.take(SampleHeard(now, CAMERA, 100, "other", None, None))
    meet(view, origins=("feed",))
    assert {stream.robot for stream in view.streams} == {"r2", "?other"}
    moved = view.streams.known("r2", CAMERA)
    assert (moved.generated, moved.sent.t_sent, moved.schedule.period) == (0, 2.0, pytest.approx(0.5))
    meet(view, origins=("feed", "other"))
    assert [stream.robot for stream in view.streams] == ["r2"]
    view.heard_digest(3.0, digest(3.0, StreamDigest(7, 1, 1, 3.0, 3.0, 10, 1.0)))
    assert moved.generated == 1


def test_an_origin_that_becomes_ours_is_no_plain_node(view):
    """Its samples enter our app side now."""
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "feed", None, None))
    view.overhearing.take(SampleHeard(1.0, CAMERA, 100, "other", None, None))
    assert view.origins.claim("feed")
    assert [stream.robot for stream in view.streams] == ["?other"]


def test_nobody_takes_over_an_origin(view):
    """Whoever claims first has it; a robot's own id and ours are never another's."""
    meet(view, origins=("app-2",))
    view.add_peer(1.0, "r3", "z-r3")
    view.heard_state(1.0, State("r3", "z-r3", "", "", origins=("app-2", "z-r1", "z-r2", "app-3")))
    robots = [view.origins.robot_of(origin) for origin in ("app-2", "z-r1", "z-r2", "app-3")]
    assert robots == ["r2", "r1", "r2", "r3"]
    view.gone("z-r2")
    assert view.origins.robot_of("app-2") == "r3"
