"""What a robot may say of itself."""

import pytest

from proxy.core.protocol.messages import Digest, State, StreamDigest
from proxy.core.view.peer import Peer
from proxy.core.view.plausible import objection, objection_to_state
from proxy.core.view.stream import Generated, Stream
from proxy.core.view.tuning import TUNING


@pytest.fixture
def peer():
    """Robot r2, whose last digest was sent at 50 and came at 100."""
    made = Peer("r2", "z2", 0.0, name="r2")
    made.heard_digest(100.0, Digest("r2", "z2", 50.0, 10, 1000, state=3))
    return made


@pytest.fixture
def stream():
    made = Stream(1, "r2", "a", None, known_until=100.0)
    made.note_generated(5, Generated(99.0, 10, 1.0))
    return made


def news(generated=6, t_generated=50.5, t_forwarded=0.0):
    return StreamDigest(1, generated, 0, t_generated, t_forwarded, 10, 1.0)


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({}, ""),
        ({"robot": "r3"}, "digest:forged"),
        ({"sent": 50.0}, "digest:old"),
        ({"sent": 20.0}, "digest:old"),
        ({"sent": 3600.0}, "digest:time"),
        ({"streams": (news(t_generated=52.5),)}, "digest:time"),
        ({"streams": (news(t_forwarded=7200.0),)}, "digest:time"),
        ({"streams": (news(),)}, ""),
        ({"streams": (news(2**40),)}, "digest:counts"),
        ({"messages": 9}, "digest:counts"),
        ({"messages": 2**50}, "digest:counts"),
        ({"bytes": 2**50}, "digest:counts"),
        ({"brief": True, "messages": 0, "bytes": 0}, ""),
        ({"brief": True, "sent": 50.0}, "digest:old"),
        ({"brief": True, "sent": 3600.0}, "digest:time"),
        ({"brief": True, "robot": "r3"}, "digest:forged"),
        ({"brief": True, "streams": (news(2**40),)}, "digest:counts"),
        ({"brief": True, "streams": (news(t_forwarded=7200.0),)}, "digest:time"),
    ],
)
def test_a_digest_must_fit_the_one_before(peer, stream, changes, wrong):
    """Its sender, its time, and all that it counts."""
    digest = Digest(**{"robot": "r2", "tag": "z2", "sent": 51.0, "messages": 11, "bytes": 2000} | changes)
    assert objection(101.0, peer, digest, lambda _: stream) == wrong


def test_what_was_said_falsely_gives_way(peer):
    """After a time without any digest that fits, the next one counts, whatever its time is."""
    digest = Digest("r2", "z2", 7.0, 0, 0)
    assert objection(101.0, peer, digest, lambda _: None) == "digest:old"
    assert objection(100.1 + TUNING.implausible_for, peer, digest, lambda _: None) == ""


def announce(peer, now):
    """An announcement of the robot comes, which tells no counts."""
    peer.heard_digest(now, Digest("r2", "z2", now - 50.0, brief=True))


def test_who_was_first_heard_by_an_announcement_may_have_sent_anything_before():
    """It has been on the air for days."""
    peer = Peer("r2", "z2", 0.0, name="r2")
    announce(peer, 100.0)
    assert objection(100.1, peer, Digest("r2", "z2", 50.1, 2**40, 2**50), lambda _: None) == ""


def test_announcements_do_not_keep_false_counts_alive(peer):
    """Somebody told large ones in a robot's name: what it tells itself counts in time, whatever it sends meanwhile."""
    peer.heard_digest(101.0, Digest("r2", "z2", 51.0, 10**6, 10**9))
    true = [Digest("r2", "z2", 52.0 + k, 11 + k, 2000 + k) for k in range(20)]
    said = []
    for k, digest in enumerate(true):
        announce(peer, 101.9 + k)
        said.append(objection(102.0 + k, peer, digest, lambda _: None))
    assert said[0] == "digest:counts"
    assert said[round(TUNING.implausible_for) :] == [""] * (20 - round(TUNING.implausible_for))


def test_a_state_must_be_the_robots_own_and_new(peer):
    """An older one counts where the robot's digests speak of it."""
    peer.state = State("r2", "z2", "", "", number=9)

    def wrong(**changes):
        return objection_to_state(peer, State(**{"robot": "r2", "zid": "z2", "mode": "", "specs": ""} | changes))

    assert wrong(number=10) == wrong(number=3) == wrong() == ""
    assert wrong(number=8) == "state:old"
    assert wrong(number=10, robot="r3") == wrong(number=10, zid="z2f") == "state:forged"
