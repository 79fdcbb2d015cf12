"""Digests of robots whose presence is not known yet."""

from proxy.core.protocol.messages import Digest
from proxy.core.view.tuning import TUNING
from proxy.core.view.unknown_senders import UnknownSenders


def digest(tag, sent=1.0):
    return Digest("r", tag, sent, 0, 0)


def test_what_a_stranger_said_is_kept_until_it_is_introduced():
    """In order, with the times of receipt, and once."""
    senders = UnknownSenders()
    for now in (1.0, 2.0):
        senders.keep(now, digest("a", now))
    assert senders.introduce("a") == [(1.0, digest("a", 1.0)), (2.0, digest("a", 2.0))]
    assert senders.introduce("a") == []


def test_unknown_senders_are_bounded():
    """The one that was silent for longest is forgotten, and of each the oldest."""
    senders = UnknownSenders()
    for number in range(TUNING.unknown_senders + 5):
        senders.keep(float(number), digest(f"t{number}"))
    assert senders.introduce("t4") == []
    assert senders.forgotten == 5
    for number in range(TUNING.unknown_digests + 2):
        senders.keep(float(number), digest("t9", float(number)))
    assert len(senders.introduce("t9")) == TUNING.unknown_digests
    assert senders.forgotten == 8
