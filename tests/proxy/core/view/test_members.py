"""The robots that are here, each under a name of its own."""

import math

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.view.members import UnknownSenders
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import CAMERA, digest, meet


def test_robots_of_one_name_are_told_apart(view):
    """Three clones and one of our own name: each has its streams, tags and claims; the plain name is inherited."""
    for zid in ("aaaa1", "aaaa2", "bbbb1"):
        assert view.add_peer(0.0, "r2", zid)
        view.heard_state(0.0, State("r2", zid, "", "", (StreamState(7, CAMERA, "camera", 0.5),), ("robot/**",)))
    view.add_peer(0.0, "r1", "cccc1")
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-aaaa", "r2-bbbb", "r1-cccc"]
    assert [peer.name for peer in [peer for peer in view.peers.values() if peer.is_namesake]] == ["r2", "r2", "r1"]
    for number, zid in enumerate(("aaaa1", "aaaa2", "bbbb1"), 1):
        view.heard_digest(1.0, Digest("r2", zid, 1.0, 0, 0, (StreamDigest(7, number, 0, 1.0, 0.0, 10, 1.0),)))
    assert {s.robot: s.generated for s in view.streams} == {"r2": 1, "r2-aaaa": 2, "r2-bbbb": 3}
    assert view.members.tags == {
        "r1": "z-r1",
        "r2": "aaaa1",
        "r2-aaaa": "aaaa2",
        "r2-bbbb": "bbbb1",
        "r1-cccc": "cccc1",
    }
    assert view.subscribers.of(view.streams.known("r2", CAMERA)) == ("aaaa2", "bbbb1")
    view.gone(1.0, "aaaa1")
    assert {s.robot: s.generated for s in view.streams} == {"r2": 2, "r2-bbbb": 3}
    assert view.subscribers.of(view.streams.known("r2", CAMERA)) == ("bbbb1",)


def test_names_with_the_same_beginning_of_their_ids_differ(view):
    """As much of the id as it takes."""
    for zid in ("aaaa1111", "aaaa2222", "aaaa2333"):
        view.add_peer(0.0, "r2", zid)
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-aaaa", "r2-aaaa2"]


def test_a_robot_that_restarted_has_its_name_when_its_old_self_leaves(view):
    """The old presence token vanishes after the new one appeared; the new one's streams count anew."""
    meet(view)
    view.heard_digest(1.0, digest(1.0, StreamDigest(7, 9, 9, 1.0, 1.0, 10, 1.0)))
    view.add_peer(2.0, "r2", "z-new")
    assert [peer.robot for peer in view.peers.values()] == ["r2", "r2-z-ne"]
    view.heard_state(2.0, State("r2", "z-new", "enforce", "", (StreamState(7, CAMERA, "camera", 0.5),)))
    view.heard_digest(2.0, Digest("r2", "z-new", 1.0, 0, 0, (StreamDigest(7, 1, 1, 1.0, 1.0, 10, 1.0),)))
    told = view.staleness.told_until("r2-z-ne")
    view.gone(1.0, "z-r2")
    assert (view.staleness.told_until("r2"), view.staleness.told_until("r2-z-ne")) == (told, math.inf)
    assert [(stream.robot, stream.generated) for stream in view.streams] == [("r2", 1)]
    assert [peer for peer in view.peers.values() if peer.is_namesake] == []
    view.gone(1.0, "z-new")
    assert list(view.streams) == []
    view.gone(1.0, "z-new")


def test_sessions_of_one_name_are_one_robot(view):
    """As long as they have not said what they want: one copy may go to them, not one each."""
    for zid in ("aaaa1", "bbbb1", "cccc1"):
        view.add_peer(0.0, "r2", zid)
    assert view.members.unannounced == 1
    view.add_peer(0.0, "r3", "dddd1")
    assert view.members.unannounced == 2
    for zid in ("aaaa1", "bbbb1", "cccc1"):
        view.heard_state(0.0, State("r2", zid, "", ""))
    assert view.members.unannounced == 1


def test_who_has_just_been_met_may_say_for_a_moment_what_it_sent_lately(make_specs):
    """Until it has, or that is over; who has no streams has nothing to say."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    assert view.newcomers.greeted_by(1.0) == -math.inf
    view.add_peer(1.0, "r2", "z-r2")
    view.add_peer(1.1, "r3", "z-r3")
    assert view.newcomers.greeted_by(1.1) == 1.1 + TUNING.greeting_time
    view.heard_state(1.1, State("r3", "z-r3", "enforce", ""))
    assert view.newcomers.greeted_by(1.1) == 1.0 + TUNING.greeting_time
    view.heard_digest(1.2, Digest("r2", "z-r2", 1.2))
    assert view.newcomers.greeted_by(1.2) == -math.inf
    view.add_peer(2.0, "r4", "z-r4")
    assert view.newcomers.greeted_by(2.0 + TUNING.greeting_time) == -math.inf


def unknown(tag, sent=1.0):
    return Digest("r", tag, sent, 0, 0)


def test_what_a_stranger_said_is_kept_until_it_is_introduced():
    """In order, with the times of receipt, and once."""
    senders = UnknownSenders()
    for now in (1.0, 2.0):
        senders.keep(now, unknown("a", now))
    assert senders.introduce("a") == [(1.0, unknown("a", 1.0)), (2.0, unknown("a", 2.0))]
    assert senders.introduce("a") == []


def test_unknown_senders_are_bounded():
    """The one that was silent for longest is forgotten, and of each the oldest."""
    senders = UnknownSenders()
    for number in range(TUNING.unknown_senders + 5):
        senders.keep(float(number), unknown(f"t{number}"))
    assert senders.introduce("t4") == []
    assert senders.forgotten == 5
    for number in range(TUNING.unknown_digests + 2):
        senders.keep(float(number), unknown("t9", float(number)))
    assert len(senders.introduce("t9")) == TUNING.unknown_digests
    assert senders.forgotten == 8
