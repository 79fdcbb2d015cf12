"""Which interface is the radio."""

import socket

import pytest

from proxy.bridge import radio
from proxy.bridge.radio import interface_of, multicast_interfaces
from proxy.errors import SessionError


def test_a_named_interface_is_taken_as_it_is():
    """Names and addresses are for Zenoh to judge."""
    assert interface_of("wlan7") == "wlan7"


def test_loopback_is_never_the_radio():
    """Only interfaces of this host that are up and can do multicast are."""
    known = {name for _, name in socket.if_nameindex()}
    assert set(multicast_interfaces()) <= known - {"lo"}
    assert radio._flags("lo") & radio._LOOPBACK


def test_an_interface_that_has_gone_has_no_flags():
    """It may go between the listing and the look at it."""
    assert radio._flags("gone") == 0


@pytest.mark.parametrize(
    ("found", "complaint"),
    [
        (["eth0", "wlan0"], "there are eth0, wlan0"),
        ([], "there is none that is up and can do multicast"),
    ],
)
def test_the_operator_is_asked_when_it_is_not_clear(monkeypatch, found, complaint):
    """Samples on the wrong interface would reach nobody."""
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: found)
    with pytest.raises(SessionError, match=rf'^mesh\.interface: to broadcast, name .* instead of "auto": {complaint}'):
        interface_of("auto")


def test_the_only_interface_is_the_radio(monkeypatch):
    """Then "auto" is clear."""
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: ["wlan0"])
    assert interface_of("auto") == "wlan0"
