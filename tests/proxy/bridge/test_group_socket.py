"""Which sockets of this process are on a port, and whether they still are."""

import socket

from proxy.bridge.group_socket import is_open, sockets_on


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
