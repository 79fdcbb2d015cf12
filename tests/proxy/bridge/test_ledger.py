"""The ledger of a link, from the declarations that pass on it."""

import pytest

from proxy.bridge.ledger import Ledger
from tests.proxy.bridge.test_wire import frame


@pytest.fixture
def changes():
    return []


@pytest.fixture
def ledger(changes):
    return Ledger(lambda: changes.append(1))


def numbered(number, text):
    return b"\x1e\x20" + bytes([number, 0, len(text)]) + text.encode()


def declared(kind, number, scope, suffix="", *, senders=True, complete=False):
    header = kind | (0x20 if suffix else 0) | (0x40 if senders else 0) | (0x80 if complete else 0)
    text = bytes([len(suffix)]) + suffix.encode() if suffix else b""
    return b"\x1e" + bytes([header, number, scope]) + text + (b"\x21\x01" if complete else b"")


def test_expressions_are_put_together_from_numbers_of_either_end(ledger, changes):
    """A scope may be a number that the main session gave or one that the voice gave."""
    ledger.read(frame(numbered(1, "theirs")), inward=True)
    ledger.read(frame(numbered(1, "ours")), inward=False)
    assert not changes
    ledger.read(frame(declared(0x02, 5, 1, "/*")), inward=True)
    ledger.read(frame(declared(0x02, 6, 1, "/a", senders=False)), inward=True)
    assert ledger.declared("subscriber") == {"theirs/*": False, "ours/a": False}
    assert len(changes) == 2


def test_what_the_voice_declares_itself_is_not_entered(ledger, changes):
    """The ledger holds what others declared."""
    ledger.read(frame(declared(0x06, 5, 0, "tok")), inward=False)
    assert ledger.declared("token") == {}
    assert not changes


def test_a_queryable_becomes_complete_and_incomplete(ledger):
    """Declaring again under the same number replaces what was known."""
    ledger.read(frame(declared(0x04, 5, 0, "q", complete=True)), inward=True)
    assert ledger.declared("queryable") == {"q": True}
    ledger.read(frame(declared(0x04, 5, 0, "q")), inward=True)
    assert ledger.declared("queryable") == {"q": False}


def test_undeclaring_by_number_and_by_expression(ledger, changes):
    """Both forms remove exactly what they name; what is not known changes nothing."""
    ledger.read(frame(declared(0x02, 5, 0, "a"), declared(0x02, 0, 0, "b")), inward=True)
    ledger.read(frame(b"\x1e\x03\x05"), inward=True)
    assert ledger.declared("subscriber") == {"b": False}
    ledger.read(frame(b"\x1e\x83\x00\x5f\x03\x01\x00b"), inward=True)
    assert ledger.declared("subscriber") == {}
    before = len(changes)
    ledger.read(frame(b"\x1e\x03\x09"), inward=True)
    assert len(changes) == before


def test_own_and_admin_keys_are_left_out(ledger):
    """What never crosses is not told, nor are the expressions of our own ingress."""
    hidden = ("@/x/router/**", "@sendworthy/r1/status", "*/**")
    for number, expression in enumerate((*hidden, "@ros2_lv/0/x", "@sendworthyish/a"), start=1):
        ledger.read(frame(declared(0x02, number, 0, expression)), inward=True)
    assert set(ledger.declared("subscriber")) == {"@ros2_lv/0/x", "@sendworthyish/a"}


def test_bytes_it_does_not_understand_break_it_loudly_once(ledger, changes, caplog):
    """A broken ledger says so, keeps what it knows and reads no more."""
    ledger.read(frame(declared(0x02, 5, 0, "a")), inward=True)
    ledger.read(frame(b"\x0a"), inward=True)
    ledger.read(frame(b"\x0a"), inward=True)
    assert ledger.broken
    assert ledger.declared("subscriber") == {"a": False}
    assert len(changes) == 2
    assert [record.levelname for record in caplog.records] == ["ERROR"]
    assert "everything is bridged" in caplog.text


def test_a_number_nobody_gave_breaks_it_too(ledger):
    """An unknown scope is an error, not an empty prefix."""
    ledger.read(frame(declared(0x02, 5, 9, "/a")), inward=True)
    assert ledger.broken


def test_a_new_link_begins_anew(ledger):
    """After a reset nothing of the old link is left."""
    ledger.read(frame(declared(0x02, 5, 0, "a"))[:4], inward=True)
    ledger.reset()
    ledger.read(frame(declared(0x02, 5, 0, "b")), inward=True)
    assert ledger.declared("subscriber") == {"b": False}
