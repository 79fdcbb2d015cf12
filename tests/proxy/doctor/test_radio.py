"""The interface of the radio; what is up, down and without multicast the system tests have."""

from dataclasses import replace

import pytest

from proxy.config import MeshConfig
from proxy.doctor import radio as looked
from proxy.doctor.finding import State
from proxy.doctor.radio import radio

DIALLED = MeshConfig(scouting=False)


def interfaces(mesh, *, running=False):
    return [(each.state, each.text) for each in radio(mesh, running=running) if each.check == "interface"]


def test_a_named_interface_is_looked_at():
    """Loopback is up and has an address."""
    assert interfaces(replace_mesh(interface="lo")) == [(State.FINE, "lo: up")]


def test_one_that_is_not_there_is_a_finding():
    """Beside those that are."""
    ((state, text),) = interfaces(replace_mesh(interface="lo,nope0"))
    assert state == State.FINDING
    assert text.startswith("there is no nope0 (but lo")


def test_a_named_interface_needs_an_address_only_where_others_are_looked_for(monkeypatch):
    """Zenoh looks for them in IPv4."""
    monkeypatch.setattr(looked.Interface, "of", lambda name, of=looked.Interface.of: replace(of(name), address=False))
    assert interfaces(replace_mesh(interface="lo")) == [(State.FINE, "lo: up")]
    ((state, text),) = interfaces(MeshConfig(interface="lo"))
    assert (state, "sudo ip address add" in text) == (State.FINDING, True)


def test_an_address_may_stand_in_its_place():
    """If it is one of this host."""
    assert interfaces(replace_mesh(interface="127.0.0.1"))[0][0] == State.FINE
    assert interfaces(replace_mesh(interface="192.0.2.1"))[0][0] == State.FINDING


@pytest.mark.parametrize(("mesh", "state"), [(MeshConfig(), State.FINDING), (DIALLED, State.FINE)])
def test_without_any_interface_nobody_is_found(monkeypatch, mesh, state):
    """That is wrong only where others are looked for."""
    monkeypatch.setattr(looked, "multicast_interfaces", list)
    assert [each for each, _ in interfaces(mesh)] == [state]


def test_to_broadcast_an_interface_must_be_clear(monkeypatch):
    """The finding is what the daemon says when it does not start."""
    monkeypatch.setattr("proxy.bridge.radio.multicast_interfaces", lambda: ["eth0", "wlan0"])
    ((state, text),) = interfaces(MeshConfig(transport="broadcast"))
    assert (state, "there are eth0, wlan0" in text) == (State.FINDING, True)


def test_each_group_in_use_is_tried_but_none_that_a_running_daemon_hears_samples_on(monkeypatch):
    """Where all robots are named, there is none."""
    monkeypatch.setattr(looked.Interface, "of", lambda name, of=looked.Interface.of: replace(of(name), multicast=True))

    def tried(mesh, *, running):
        return [each.text.split(" is ")[0] for each in radio(mesh, running=running) if each.check == "multicast"]

    broadcast = replace_mesh(interface="lo", transport="broadcast", scouting=True)
    scouting, samples = (f"lo: a message to {group}" for group in ("224.0.0.225:7448", "224.0.0.226:7449"))
    assert tried(broadcast, running=False) == [scouting, samples]
    assert tried(broadcast, running=True) == [scouting]
    assert tried(replace_mesh(interface="lo"), running=False) == []


def replace_mesh(**values):
    return MeshConfig(**{"scouting": False, **values})
