"""Digests of robots whose presence is not known yet."""

from proxy.core.protocol.messages import Digest
from proxy.core.view.unknown_senders import MOST, MOST_EACH, Strangers


def digest(tag, sent=1.0):
    return Digest("r", tag, sent, 0, 0)


def test_what_a_stranger_said_is_kept_until_it_is_introduced():
    """In order, with the times of receipt, and once."""
    strangers = Strangers()
    for now in (1.0, 2.0):
        strangers.keep(now, digest("a", now))
    assert strangers.introduce("a") == [(1.0, digest("a", 1.0)), (2.0, digest("a", 2.0))]
    assert strangers.introduce("a") == []


def test_strangers_are_bounded():
    """The one that was silent for longest is forgotten, and of each the oldest."""
    strangers = Strangers()
    for number in range(MOST + 5):
        strangers.keep(float(number), digest(f"t{number}"))
    assert strangers.introduce("t4") == []
    assert strangers.forgotten == 5
    for number in range(MOST_EACH + 2):
        strangers.keep(float(number), digest("t9", float(number)))
    assert len(strangers.introduce("t9")) == MOST_EACH
    assert strangers.forgotten == 8
