"""The table of a link, from the declarations that pass on it."""

from dataclasses import replace

import pytest

from proxy.bridge.declarations import table as table_module
from proxy.bridge.declarations.table import DeclarationTable
from proxy.bridge.declarations.tuning import TUNING
from tests.proxy.bridge.declarations.test_wire import frame


@pytest.fixture
def changes():
    return []


@pytest.fixture
def table(changes):
    return DeclarationTable(lambda: changes.append(1))


def numbered(number, text):
    return b"\x1e\x20" + bytes([number, 0, len(text)]) + text.encode()


def declared(kind, number, scope, suffix="", *, senders=True, complete=False):
    header = kind | (0x20 if suffix else 0) | (0x40 if senders else 0) | (0x80 if complete else 0)
    text = bytes([len(suffix)]) + suffix.encode() if suffix else b""
    return b"\x1e" + bytes([header, number, scope]) + text + (b"\x21\x01" if complete else b"")


def test_expressions_are_put_together_from_numbers_of_either_end(table, changes):
    """A scope may be a number that the main session gave or one that the mirror session gave."""
    table.read(frame(numbered(1, "theirs")), inward=True)
    table.read(frame(numbered(1, "ours")), inward=False)
    assert not changes
    table.read(frame(declared(0x02, 5, 1, "/*")), inward=True)
    table.read(frame(declared(0x02, 6, 1, "/a", senders=False)), inward=True)
    assert table.declared("subscriber") == {"theirs/*": False, "ours/a": False}
    assert len(changes) == 2


def test_what_the_mirror_session_declares_itself_is_not_entered(table, changes):
    """The table holds what others declared."""
    table.read(frame(declared(0x06, 5, 0, "tok")), inward=False)
    assert table.declared("token") == {}
    assert not changes


def test_a_queryable_becomes_complete_and_incomplete(table):
    """Declaring again under the same number replaces what was known."""
    table.read(frame(declared(0x04, 5, 0, "q", complete=True)), inward=True)
    assert table.declared("queryable") == {"q": True}
    table.read(frame(declared(0x04, 5, 0, "q")), inward=True)
    assert table.declared("queryable") == {"q": False}


def test_undeclaring_by_number_and_by_expression(table, changes):
    """Both forms remove exactly what they name; what is not known changes nothing."""
    table.read(frame(declared(0x02, 5, 0, "a"), declared(0x02, 0, 0, "b")), inward=True)
    table.read(frame(b"\x1e\x03\x05"), inward=True)
    assert table.declared("subscriber") == {"b": False}
    table.read(frame(b"\x1e\x83\x00\x5f\x03\x01\x00b"), inward=True)
    assert table.declared("subscriber") == {}
    before = len(changes)
    table.read(frame(b"\x1e\x03\x09"), inward=True)
    assert len(changes) == before


def test_tokens_that_ended_are_told_once(table):
    """Not while another one of the same name is alive; also when there is one again."""
    table.read(frame(declared(0x06, 5, 0, "a"), declared(0x06, 6, 0, "a"), declared(0x02, 5, 0, "b")), inward=True)
    table.read(frame(b"\x1e\x07\x05", b"\x1e\x03\x05"), inward=True)
    assert table.declared("token") == {"a": False}
    assert table._alive == {"a": 1}, "only tokens are counted"
    assert "b" not in table._alive
    assert table.ended_tokens() == set()
    table.read(frame(b"\x1e\x07\x06", declared(0x06, 7, 0, "a")), inward=True)
    assert table.declared("token") == {"a": False}
    assert table.ended_tokens() == {"a"}
    table.read(frame(declared(0x06, 7, 0, "a")), inward=True)
    assert table.ended_tokens() == set()
    table.read(frame(declared(0x06, 7, 0, "other")), inward=True)
    assert table.ended_tokens() == {"a"}


def test_what_is_gone_is_taken_out_unless_it_was_declared_anew(table, changes):
    """Meanwhile, with the same name: routers number nothing."""
    table.read(frame(declared(0x02, 5, 0, "a"), declared(0x02, 6, 0, "b"), declared(0x02, 7, 0, "c")), inward=True)
    told = table.entries("subscriber")
    table.read(frame(declared(0x02, 6, 0, "b")), inward=True)
    before = len(changes)
    table.remove("subscriber", {name: entry for name, entry in told.items() if entry[0] != "c"})
    assert table.declared("subscriber") == {"b": False, "c": False}
    assert len(changes) > before


def test_own_and_admin_keys_are_left_out(table):
    """What never crosses is not told."""
    hidden = ("@/x/router/**", "@sendworthy/r1/status")
    for number, expression in enumerate((*hidden, "@ros2_lv/0/x", "@sendworthyish/a", "*/**"), start=1):
        table.read(frame(declared(0x02, number, 0, expression)), inward=True)
    assert set(table.declared("subscriber")) == {"@ros2_lv/0/x", "@sendworthyish/a", "*/**"}


def test_bytes_it_does_not_understand_break_it_loudly_once(table, changes, caplog):
    """A broken table says so, keeps what it knows and reads no more."""
    table.read(frame(declared(0x02, 5, 0, "a")), inward=True)
    table.read(frame(b"\x0a"), inward=True)
    table.read(frame(b"\x0a"), inward=True)
    assert table.broken
    assert table.declared("subscriber") == {"a": False}
    assert len(changes) == 2
    assert [record.levelname for record in caplog.records] == ["ERROR"]
    assert "everything is bridged" in caplog.text


def test_a_number_nobody_gave_breaks_it_too(table):
    """An unknown scope is an error, not an empty prefix."""
    table.read(frame(declared(0x02, 5, 9, "/a")), inward=True)
    assert table.broken


def test_a_new_link_begins_anew(table):
    """After a reset nothing of the old link is left."""
    table.read(frame(declared(0x02, 5, 0, "a"))[:4], inward=True)
    table.reset()
    table.read(frame(declared(0x02, 5, 0, "b")), inward=True)
    assert table.declared("subscriber") == {"b": False}


QUERY = bytes.fromhex("bc01" + "0003612f62" + "a11c" + "b401" + "26b817" + "63" + "01" + "03783d31")
"""`a/b?x=1` to all, within 3 s, with priority 4, waiting for room and express."""
BARE = bytes.fromhex("3c02" + "0003612f62" + "03")


def test_how_a_query_was_asked_can_be_taken_once(table, changes):
    """Oldest first for one key and parameters; it changes nothing of what is declared."""
    table.read(frame(QUERY, BARE, BARE), inward=True)
    asked = table.take("a/b", "x=1")
    assert (asked.target, asked.timeout, asked.qos) == (1, 3.0, 0x1C)
    assert table.take("a/b", "x=1") is None
    assert [table.take("a/b", "").timeout for _ in range(2)] == [None, None]
    assert table.take("a/b", "") is None
    assert not changes


def test_what_nobody_takes_is_forgotten(table, monkeypatch):
    """The number of remembered queries is bounded, and so is their number for one key."""
    monkeypatch.setattr(table_module, "TUNING", replace(table_module.TUNING, queries_remembered=2))
    for name in b"abc":
        table.read(frame(b"\x3c\x01\x00\x01" + bytes([name]) + b"\x03"), inward=True)
    assert [table.take(key, "") is None for key in "abc"] == [True, False, False]
    table.read(frame(BARE, BARE, QUERY, BARE), inward=True)
    assert [table.take("a/b", "") is None for _ in range(3)] == [False, False, True]


def test_a_query_that_came_as_its_queryable_went_is_no_other_one(table, monkeypatch):
    """Nobody is told of it, so nobody takes it: not for longer than it lasts, or than taking it may take."""
    now = [100.0]
    monkeypatch.setattr(table_module.clock, "monotonic", lambda: now[0])
    table.read(frame(QUERY, BARE), inward=True)
    now[0] += TUNING.query_taken / 2
    table.read(frame(QUERY, BARE), inward=True)
    now[0] += TUNING.query_taken * 0.6
    assert [table.take("a/b", "") is None for _ in range(2)] == [False, True]
    assert table.asked("a/b", "x=1") is not None
    now[0] += TUNING.query_taken
    assert table.asked("a/b", "x=1") is None
    assert table.take("a/b", "x=1") is None


def test_queries_of_the_mirror_session_itself_are_not_remembered(table):
    """Only those that reach it."""
    table.read(frame(QUERY), inward=False)
    assert table.take("a/b", "x=1") is None


def test_the_edition_tells_whether_to_look(table):
    """It grows with every change, and what is told stays the same mapping until then."""
    table.read(frame(declared(0x02, 5, 0, "a")), inward=True)
    before, told = table.edition, table.declared("subscriber")
    table.read(frame(BARE, declared(0x02, 6, 0, "@/hidden")), inward=True)
    assert (table.edition, table.declared("subscriber") is told) == (before, True)
    table.read(frame(declared(0x06, 7, 0, "t")), inward=True)
    assert table.edition > before
    assert table.declared("subscriber") is told
