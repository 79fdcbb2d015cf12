"""Which interface is the radio."""

import socket

import pytest

from proxy.bridge import radio
from proxy.bridge.radio import Scouted, index_of, interface_of, multicast_interfaces, only_link_local
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


def test_an_interface_that_is_known_to_be_the_radio_stays_so_when_others_come(monkeypatch):
    """As when somebody plugs in a cable: the robot could not join its group anew."""
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: ["eth0", "wlan0"])
    assert interface_of("auto", "wlan0") == "wlan0"
    assert interface_of("wlan1", "wlan0") == "wlan1"
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: ["wlan1"])
    assert interface_of("auto", "wlan0") == "wlan1"


def test_a_group_of_ipv6_needs_an_address_that_is_not_link_local(monkeypatch, tmp_path):
    """Zenoh cannot send from such a one, and says only that an argument is invalid."""
    listed, group = tmp_path / "if_inet6", "[ff02::226]:7449"
    monkeypatch.setattr(radio, "_ADDRESSES", listed)
    assert only_link_local("wlan0", group)
    local = f"fe80{28 * '0'} 02 40 20 80    wlan0\nfd00{28 * '0'} 03 40 00 80     eth0\n"
    listed.write_text(local)
    assert only_link_local("wlan0", group)
    assert not only_link_local("eth0", group)
    assert not only_link_local("wlan0", "224.0.0.226:7449")
    assert not only_link_local("fd00::1", group)
    listed.write_text(f"{local}fd00{28 * '0'} 02 40 00 82    wlan0\n")
    assert not only_link_local("wlan0", group)


def test_an_interface_has_a_number_by_its_name_and_by_its_address(monkeypatch, tmp_path):
    """One that nobody has is said in the kernel's words."""
    listed = tmp_path / "if_inet6"
    monkeypatch.setattr(radio, "_ADDRESSES", listed)
    listed.write_text(f"fd00{27 * '0'}1 0b 40 00 80    wlan0\n")
    assert index_of("lo") == socket.if_nametoindex("lo")
    assert index_of("fd00::1") == 11
    for gone in ("fd00::2", "10.0.0.7"):
        with pytest.raises(OSError, match="Cannot assign requested address"):
            index_of(gone)


def test_an_interface_that_comes_up_later_is_named(monkeypatch):
    """Zenoh looks for nobody there; a robot that boots before its radio is up would not know why it is alone."""
    up = set()
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: sorted(up | {"eth0"}))
    monkeypatch.setattr(radio, "_has_address", lambda name: name in up)
    scouted, named = Scouted("auto"), Scouted("wlan0")
    assert scouted.warnings()[0].startswith("mesh.interface: there is no interface, so no robots are found")
    assert 'no interface "wlan0" with an address' in named.warnings()[0]
    up.add("wlan0")
    late = ["mesh.interface: wlan0 came up after the daemon did; to find robots there, restart it"]
    assert scouted.warnings() == named.warnings() == late
    assert Scouted("auto").warnings() == Scouted("wlan0").warnings() == Scouted("10.0.0.7").warnings() == []


def test_an_interface_with_another_address_is_named(monkeypatch):
    """As after another lease: Zenoh looks for robots from the address that was there when its session opened."""
    scouted = Scouted("lo")
    monkeypatch.setattr(radio, "_address", lambda _: "10.0.0.8")
    (warning,) = scouted.warnings()
    assert warning == "mesh.interface: lo had 127.0.0.1 and has 10.0.0.8 now; to find robots, restart the daemon"
    monkeypatch.setattr(radio, "_address", lambda _: "")
    assert scouted.warnings() == []


def test_loopback_has_an_address_and_no_other_interface_is_made_up():
    """The kernel is asked, about names of any length."""
    assert Scouted("lo").warnings() == []
    assert Scouted("nowhere" * 5).warnings()


def test_the_only_interface_is_the_radio(monkeypatch):
    """Then "auto" is clear."""
    monkeypatch.setattr(radio, "multicast_interfaces", lambda: ["wlan0"])
    assert interface_of("auto") == "wlan0"
