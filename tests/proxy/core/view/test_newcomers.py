"""Of which robots it is not known what they send."""

import pytest

from proxy.core.protocol.messages import Digest, tag
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING

BEGAN = 5.0


@pytest.fixture
def met(view):
    """The same view: it knows of r2, and its own stream began 5 s later."""
    view.add_peer(0.0, "r2", "z-r2")
    view.peers[tag("z-r2")].take_part(plain=False)
    view.streams.touch(BEGAN, "r1", "robot/r1/camera").note_generated(1, Generated(BEGAN, 100, 1.0))
    return view


WORDS = 10.0


def known(view, now, words_take=WORDS):
    return not view.newcomers.little_known(now, words_take)


def test_a_robot_is_little_known_until_it_tells_of_a_stream(met):
    """Where robots may tell little that takes longer; after a while who told nothing has nothing."""
    later = BEGAN + 0.9 * TUNING.newcomer_words * WORDS
    assert not known(met, later)
    assert known(met, later, words_take=1.0)
    assert known(met, BEGAN + 1.1 * TUNING.newcomer_words * WORDS)
    met.streams.touch(later, "r2", "robot/r2/camera").note_generated(1, Generated(later, 100, 1.0))
    assert known(met, later)


def test_in_a_large_team_only_who_has_just_come_is_little_known(met):
    """Most of it only listen, and have no word left to say so: one that sends among thirty was held up for 30 s."""
    later = BEGAN + 1.1 * TUNING.newcomer_time
    assert not known(met, later)
    for number in range(TUNING.newcomers):
        met.add_peer(0.0, f"p{number}", f"z-p{number}")
    assert known(met, later)
    assert len(met.newcomers.little_known(BEGAN, WORDS)) == TUNING.newcomers + 1


def test_of_those_that_told_nothing_as_many_send_as_of_the_others(met):
    """As one after the other says that it only listens, ever fewer of the rest are taken to send."""
    for number in range(9):
        met.add_peer(0.0, f"p{number}", f"z-p{number}")
    found = [len(met.newcomers.little_known(8.0, WORDS))]
    for number in range(9):
        peer = met.peers[tag(f"z-p{number}")]
        peer.heard_digest(8.0, Digest(f"p{number}", peer.tag, 8.0, 0, 0))
        found.append(len(met.newcomers.little_known(8.0, WORDS)))
    assert found == sorted(found, reverse=True)
    assert (found[0], found[3], found[-1]) == (10, 4, 1)


def test_one_that_tells_of_a_stream_may_have_others_for_a_while(met):
    """They are told one after the other."""
    met.streams.touch(BEGAN, "r2", "robot/r2/camera").note_generated(1, Generated(BEGAN, 100, 1.0))
    assert not known(met, BEGAN + 0.9 * TUNING.newcomer_time)
    assert known(met, BEGAN + 1.1 * TUNING.newcomer_time)


@pytest.mark.parametrize(("at", "messages", "listens"), [(1.0, 0, False), (8.0, 0, True), (8.0, 3, False)])
def test_one_that_says_that_it_has_sent_nothing_since_we_do_only_listens(met, at, messages, listens):
    """What it said before we began tells nothing."""
    met.peers[tag("z-r2")].heard_digest(at, Digest("r2", tag("z-r2"), at, messages, 100 * messages))
    assert known(met, 40.0) is listens


def test_a_plain_node_says_nothing_of_itself(met):
    """What it sends is overheard."""
    met.peers[tag("z-r2")].take_part(plain=True)
    assert known(met, BEGAN)
