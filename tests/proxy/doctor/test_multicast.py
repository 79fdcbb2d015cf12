"""Whether multicast works on an interface, here on loopback: what it takes elsewhere the system tests have."""

from dataclasses import replace

from proxy.bridge.radio import Interface
from proxy.doctor.finding import State
from proxy.doctor.multicast import multicast
from tests.ports import free_port

LOOPBACK = replace(Interface.of("lo"), multicast=True)


def test_a_message_that_comes_back_is_fine():
    """So robots that listen there would hear it."""
    group = f"224.0.0.225:{free_port()}"
    found = multicast(LOOPBACK, group)
    assert (found.state, found.text) == (State.FINE, f"lo: a message to {group} is heard")


def test_a_message_that_does_not_come_back_is_a_finding(monkeypatch):
    """Here since IPv6 keeps no copy for this host on loopback, or is not there at all."""
    monkeypatch.setattr("proxy.doctor.multicast._WAIT", 0.1)
    found = multicast(LOOPBACK, f"[ff02::226]:{free_port()}")
    assert found.state == State.FINDING
    assert found.text.endswith("or set mesh.scouting = false and name the robots in mesh.connect")


def test_an_interface_that_does_none_is_a_finding():
    """With what switches it on."""
    found = multicast(Interface.of("lo"), "224.0.0.225:7448")
    assert found.state == State.FINDING
    assert "sudo ip link set dev lo multicast on, or set mesh.scouting = false" in found.text


def test_an_interface_that_has_gone_is_a_finding():
    """The kernel says why it cannot."""
    found = multicast(replace(LOOPBACK, name="gone", index=1 << 20), f"224.0.0.225:{free_port()}")
    assert found.state == State.FINDING
    assert "gone cannot send to 224.0.0.225" in found.text
