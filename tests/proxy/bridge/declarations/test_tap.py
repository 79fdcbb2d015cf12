"""The tap passes every byte on, in both directions, for one link after the other."""

import socket

import pytest

from proxy.bridge.declarations.table import DeclarationTable
from proxy.bridge.declarations.tap import DeclarationTap
from proxy.bridge.declarations.widening import InterestWidening
from tests.proxy.bridge.declarations.test_table import declared
from tests.proxy.bridge.declarations.test_widening import FIRST
from tests.proxy.bridge.declarations.test_wire import frame
from tests.waiting import wait_until


@pytest.fixture
def far(stack, tmp_path):
    listener = stack.enter_context(socket.socket(socket.AF_UNIX))
    listener.bind(str(tmp_path / "far"))
    listener.listen()
    listener.settimeout(5.0)
    return listener


def connect(stack, path):
    link = stack.enter_context(socket.socket(socket.AF_UNIX))
    link.settimeout(5.0)
    link.connect(str(path))
    return link


def test_bytes_pass_unchanged_and_are_read(stack, tmp_path, far):
    """Both ends see what the other wrote, and the table what was declared."""
    table = DeclarationTable(lambda: None)
    tap = DeclarationTap(tmp_path / "near", tmp_path / "far", table)
    stack.callback(tap.close)
    near = connect(stack, tmp_path / "near")
    other = stack.enter_context(far.accept()[0])
    near.sendall(b"\x01\x00\x04")
    assert other.recv(100) == b"\x01\x00\x04"
    told = frame(declared(0x02, 5, 0, "a"))
    other.sendall(told)
    assert near.recv(100) == told
    assert table.declared("subscriber") == {"a": False}


def test_a_link_that_ends_ends_on_both_sides_and_another_may_follow(stack, tmp_path, far):
    """When one end closes so does the other, and the next link starts with an empty table."""
    table = DeclarationTable(lambda: None)
    stack.callback(DeclarationTap(tmp_path / "near", tmp_path / "far", table).close)
    near = connect(stack, tmp_path / "near")
    other = stack.enter_context(far.accept()[0])
    other.sendall(frame(declared(0x02, 5, 0, "a")))
    wait_until(lambda: table.declared("subscriber"), what="the declaration")
    near.close()
    assert other.recv(100) == b""
    connect(stack, tmp_path / "near")
    stack.enter_context(far.accept()[0])
    wait_until(lambda: not table.declared("subscriber"), what="the reset")


def test_closing_cuts_the_link(stack, tmp_path, far):
    """A closed tap leaves no link behind and accepts none."""
    tap = DeclarationTap(tmp_path / "near", tmp_path / "far", DeclarationTable(lambda: None))
    near = connect(stack, tmp_path / "near")
    stack.enter_context(far.accept()[0])
    tap.close()
    assert near.recv(100) == b""
    with pytest.raises(OSError, match="refused"):
        connect(stack, tmp_path / "near")


def test_a_far_end_that_is_not_there_ends_the_link(stack, tmp_path):
    """Whoever connects while nobody listens behind is cut off, and may try again."""
    stack.callback(DeclarationTap(tmp_path / "near", tmp_path / "nobody", DeclarationTable(lambda: None)).close)
    for _ in range(2):
        assert connect(stack, tmp_path / "near").recv(100) == b""


def test_interests_are_widened_on_the_way_out(stack, tmp_path, far):
    """The far end is asked for everything, and it is known when that has been done."""
    tap = DeclarationTap(tmp_path / "near", tmp_path / "far", DeclarationTable(lambda: None), interests=1)
    stack.callback(tap.close)
    near = connect(stack, tmp_path / "near")
    other = stack.enter_context(far.accept()[0])
    assert not tap.widened.is_set()
    near.sendall(FIRST)
    assert other.recv(100) == InterestWidening(1).feed(FIRST) != FIRST
    assert tap.widened.is_set()
