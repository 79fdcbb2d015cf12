"""Which sockets of this process are on a port, and whether they still are."""

import os
import socket
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest

from proxy.bridge import group_socket
from proxy.bridge.group_socket import GroupSockets, is_open, refusal, sockets_on
from proxy.bridge.tuning import TUNING
from tests.ports import free_port


def test_a_socket_is_found_by_its_port_until_it_is_closed():
    """Another one with its descriptor is not taken for it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
        ((descriptor, inode),) = sockets_on(f"224.0.0.226:{port}")
        assert descriptor == one.fileno()
        assert is_open(descriptor, inode)
        assert not is_open(descriptor, inode + 1)
    assert not is_open(descriptor, inode)
    assert not sockets_on(f"224.0.0.226:{port}")


def test_where_the_kernel_has_no_table_nothing_is_found(monkeypatch):
    """As without IPv6."""
    monkeypatch.setattr("proxy.bridge.group_socket._TABLES", ("/proc/self/net/none",))
    assert sockets_on("224.0.0.226:7449") == frozenset()


def test_a_session_without_a_socket_was_deafened_unless_none_is_ever_found():
    """Where nothing can be told, as where opening failed, nothing is said."""
    port = free_port()
    sockets = GroupSockets(f"224.0.0.226:{port}")
    assert not sockets.closed
    with sockets.found():
        pass
    assert not sockets.closed
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        with sockets.found():
            one.bind(("127.0.0.1", port))
        assert not sockets.closed
    assert sockets.closed
    with suppress(OSError), sockets.found():
        raise OSError
    assert not sockets.closed
    with sockets.found():
        pass
    assert sockets.closed


def test_a_socket_of_which_nothing_is_read_is_stuck():
    """Whatever comes meanwhile; who is busy reads later."""
    port = free_port()
    sockets = GroupSockets(f"224.0.0.226:{port}")
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as two,
    ):
        with sockets.found():
            one.bind(("127.0.0.1", port))
        assert not sockets.stuck(2, busy=False)
        for busy, stuck in ((False, False), (False, False), (False, True), (True, False), (False, False)):
            two.sendto(b"x", ("127.0.0.1", port))
            assert sockets.stuck(2, busy=busy) is stuck
        assert sockets.stuck(2, busy=False)
        for _ in range(5):
            one.recv(1)
        assert not sockets.stuck(2, busy=False)
        two.sendto(b"x", ("127.0.0.1", port))
        assert [sockets.stuck(2, busy=False) for _ in range(3)] == [False, False, True]
    assert not sockets.stuck(2, busy=False)


def test_as_much_may_wait_as_this_host_allows():
    """The kernel's own 208 kB are less than one large sample, and what finds no room is lost."""
    most = int(Path("/proc/sys/net/core/rmem_max").read_text())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        before = one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        port = free_port()
        with GroupSockets(f"224.0.0.226:{port}").found():
            one.bind(("127.0.0.1", port))
        after = one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    assert after == 2 * min(most, TUNING.group_buffer)  # the kernel doubles it, for what it adds to each datagram
    assert after > before


def test_a_socket_that_has_more_room_keeps_it(monkeypatch):
    """As where a host gives each socket more than the most that a program may ask for."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        before = one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        monkeypatch.setattr(group_socket, "TUNING", replace(TUNING, group_buffer=before // 4))
        port = free_port()
        with GroupSockets(f"224.0.0.226:{port}").found():
            one.bind(("127.0.0.1", port))
        assert one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) == before


def test_a_file_in_the_place_of_a_socket_that_was_closed_is_left_alone(tmp_path):
    """As one of a recording while the radio is off: each look left a descriptor, and soon there were no more."""
    port, path = free_port(), tmp_path / "file"
    sockets = GroupSockets(f"224.0.0.226:{port}")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        with sockets.found():
            one.bind(("127.0.0.1", port))
        with path.open("w") as file:
            os.dup2(file.fileno(), one.fileno())
        for _ in range(3):
            assert not sockets.stuck(2, busy=False)
        assert sockets.closed
        assert sum(each.resolve() == path for each in Path("/proc/self/fd").iterdir()) == 1


@pytest.mark.parametrize("interface", ["lo", "127.0.0.1"])
def test_nobody_hears_how_a_host_tries_to_send(interface):
    """On loopback everybody would: there it is not tried."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard:
        heard.bind(("", 0))
        group = "224.0.0.226", heard.getsockname()[1]
        own = socket.inet_aton("127.0.0.1")
        heard.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group[0]) + own)
        heard.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, own)
        assert refusal(f"{group[0]}:{group[1]}", interface) == ""
        heard.sendto(b"next", group)
        assert heard.recv(10) == b"next"


@pytest.mark.parametrize("group", ["224.0.0.226:7449", "[ff02::226]:7449"])
def test_a_host_says_why_it_cannot_send(group):
    """In the kernel's words."""
    assert refusal(group, "gone") == "no interface with this name"


@pytest.mark.parametrize(("group", "address"), [("224.0.0.226:7449", "192.0.2.7"), ("[ff02::226]:7449", "2001:db8::7")])
def test_an_address_that_no_interface_has_is_refused(group, address):
    """As after the radio got another one."""
    assert refusal(group, address) == "Cannot assign requested address"
