"""What is learnt of another robot from its digests and samples."""

from proxy.core.protocol.messages import State, StreamState
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
