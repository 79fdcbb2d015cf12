"""What is learnt of another robot from its digests and samples."""

from dataclasses import replace

from proxy.core.protocol.messages import Digest, State, StreamState
from proxy.core.view.peer import Peer
from tests.proxy.core.view.met import CAMERA, meet


def test_an_update_changes_only_the_streams_it_names(view):
    """One of another state than ours is not taken in."""
    meet(view, number=4, subscriptions=("robot/**",))
    update = State("r2", "z-r2", "", "", (StreamState(9, "robot/r2b/camera", "camera", 0.25),), number=5, since=4)
    assert view.heard_state(1.0, update)
    peer = view.peers["z-r2"]
    assert (peer.number, peer.keys[7], peer.keys[9], peer.subscriptions) == (
        5,
        CAMERA,
        "robot/r2b/camera",
        ("robot/**",),
    )
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", (), number=9, since=8))
    crowd = tuple(StreamState(100 + n, f"k{n}", "camera", 0.5) for n in range(4096))
    assert not view.heard_state(1.0, State("r2", "z-r2", "", "", crowd, number=6, since=5))
    assert peer.number == 5


def test_of_two_states_of_one_number_that_differ_one_is_forged():
    """Then nobody knows what its clock is wrong by; a state of another number says so."""
    peer, state = Peer("r2", "z-r2", 0.0), State("r2", "z-r2", "", "", wall_offset=5.0, number=3, clock_error=0.01)
    peer.take_state(1.0, state)
    assert peer.clock_error == 0.01
    peer.take_state(2.0, replace(state, wall_offset=9.0))
    assert (peer.clock_error, peer.inbound.wall_offset) == (0.0, 9.0)
    peer.take_state(3.0, replace(state, wall_offset=9.0, number=4))
    assert peer.clock_error == 0.01


def test_an_announcement_does_not_say_how_much_its_robot_sent():
    """The next one has to follow it all the same."""
    peer = Peer("r2", "z-r2", 0.0)
    peer.heard_digest(1.0, Digest("r2", "z-r2", 1.0, 7, 700))
    peer.heard_digest(2.0, Digest("r2", "z-r2", 2.0, brief=True))
    assert (peer.counted, peer.digest.sent, peer.digest_received) == ((1.0, 7, 700), 2.0, 2.0)
    peer.restart()
    assert peer.digest is None
