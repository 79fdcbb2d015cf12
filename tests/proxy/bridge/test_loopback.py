"""Where `localhost` is served."""

import socket

import pytest

from proxy.bridge.loopback import has_ipv6, present
from proxy.config import AppConfig

BOTH = ("tcp/127.0.0.1:7447", "tcp/[::1]:7447")


def test_the_default_serves_both_addresses_of_localhost(caplog):
    """With IPv6 nothing is left out and nothing is said."""
    assert present(AppConfig().listen, ipv6=True) == BOTH
    assert not caplog.records


def test_without_ipv6_the_other_address_is_left(caplog):
    """The start does not fail, and the log says where applications connect."""
    caplog.set_level("INFO")
    assert present(BOTH, ipv6=False) == BOTH[:1]
    assert "no IPv6 on this host: applications connect to tcp/127.0.0.1:7447 only" in caplog.text


@pytest.mark.parametrize("listen", [("tcp/[::1]:7447",), ("tcp/0.0.0.0:7447",), ("tcp/[::]:7447",)])
def test_nothing_else_is_touched(listen, caplog):
    """Who names only ::1 shall see it fail; other addresses are none of our business."""
    caplog.set_level("INFO")
    assert present(listen, ipv6=False) == listen
    assert not caplog.records


def test_the_host_is_asked(monkeypatch):
    """A host has ::1 when a socket can be bound to it."""
    with socket.socket(socket.AF_INET) as other:
        other.bind(("127.0.0.1", 0))
    monkeypatch.setattr(socket, "AF_INET6", socket.AF_INET)  # a family that cannot bind ::1
    assert not has_ipv6()
