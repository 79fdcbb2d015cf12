"""Up to when news tells of streams."""

import math

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA


def test_how_long_a_stream_is_silent_tells_when_its_robot_spoke_not_when_that_came(make_specs):
    """Where news take as long as ten periods no stream is over for it."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    view.subscribers.set_own(("robot/**",))
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_state(0.0, State("r2", "z-r2", "enforce", "", (StreamState(1, CAMERA, "camera", 0.1),)))
    view.heard_digest(0.5, Digest("r2", "z-r2", 0.5))
    for count in range(1, 40):
        sent = 0.5 + 0.1 * count
        news = StreamDigest(1, count, count, sent, sent, 100, 1.0, (), 0.1)
        view.heard_digest(sent + 3.0, Digest("r2", "z-r2", sent, streams=(news,)))
    assert view.contention.competes(sent + 3.0, view.streams.known("r2", CAMERA))
    view.heard_digest(sent + 5.0, Digest("r2", "z-r2", sent + 1.9))
    assert not view.contention.competes(sent + 5.0, view.streams.known("r2", CAMERA))


def test_an_announcement_does_not_tell_that_other_streams_are_silent(view):
    """It leaves out what is small."""
    view.add_peer(0.0, "r2", "z-r2")
    view.heard_digest(1.0, Digest("r2", tag("z-r2"), 0.9))
    told = view.staleness.reported_until("r2", math.inf)
    view.heard_digest(2.0, Digest("r2", tag("z-r2"), 1.9, brief=True))
    assert view.staleness.reported_until("r2", math.inf) == told
    view.heard_digest(3.0, Digest("r2", tag("z-r2"), 2.9))
    assert view.staleness.reported_until("r2", math.inf) > told
