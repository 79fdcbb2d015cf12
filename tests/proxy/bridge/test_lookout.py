"""Applications that can be reached around the daemon are found, on real sessions."""

import socket
from dataclasses import replace

import pytest

from proxy.bridge.lookout import Lookout, around, guarded, on_this_host
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import closing, free_endpoint, free_group, outside, plain_session, scouting
from tests.waiting import wait_until


@pytest.fixture
def group():
    """A scouting group that nobody else uses."""
    return free_group()


def test_who_answers_scouts_on_the_network_is_found_and_forgotten(stack, group):
    """An application in the default configuration is a warning that says what to do, for as long as it is there."""
    app = scouting(group, f"tcp/{outside()}:0")
    ours = closing(stack, scouting(group, f"tcp/{outside()}:0"))
    lookout = Lookout("auto", [str(ours.zid())], group)
    wait_until(lambda: lookout.look() or lookout.warnings(), what="the answer of the application")
    (warning,) = lookout.warnings()
    assert warning.startswith(f"the Zenoh peer {app.zid()} on this robot answers everybody on the radio, at tcp/")
    assert "deploy/apps/client.json5" in warning
    app.close()
    lookout.look()
    assert not lookout.warnings()


def test_who_listens_on_this_host_only_is_no_concern(stack, group):
    """Answers that name nothing but loopback lead nobody around the daemon."""
    closing(stack, scouting(group, "tcp/127.0.0.1:0"))
    lookout = Lookout("auto", [], group)
    lookout.look()
    assert not lookout.warnings()


def test_it_looks_again_and_again_and_an_interface_may_be_missing(monkeypatch, stack, group):
    """On its thread it finds who comes later; without the interface it finds nobody and does not fail."""
    monkeypatch.setattr("proxy.bridge.lookout.TUNING", replace(TUNING, lookout_interval=0.05))
    lookout, blind = Lookout("auto", [], group), Lookout("nowhere0", [], group)
    for each in (lookout, blind):
        stack.callback(each.close, 1.0)
        each.start()
    closing(stack, scouting(group, f"tcp/{outside()}:0"))
    wait_until(lookout.warnings, what="the warning")
    assert not blind.warnings()


def test_applications_that_are_on_the_mesh_themselves_are_named(stack):
    """Own ones are known by their links with the app side, those of others by what their robots say."""
    at_app, at_mesh = free_endpoint(), free_endpoint()
    app = closing(stack, plain_session("router", listen=(at_app,)))
    mesh = closing(stack, plain_session("peer", listen=(at_mesh,)))
    own = closing(stack, plain_session("peer", connect=(at_app, at_mesh)))
    other, robot = (closing(stack, plain_session("peer", connect=(at_mesh,))) for _ in range(2))
    wait_until(lambda: len(mesh.info.links()) == 3 and app.info.links(), what="the links")
    found = sorted(around(app, mesh, {str(other.zid()): "r2"}), key=lambda text: "robot r2" in text)
    assert len(found) == 2
    assert found[0].startswith(f"the application {own.zid()} of this robot is on the mesh itself")
    assert found[1].startswith(f"the application {other.zid()} of robot r2 is on the mesh itself")
    assert str(robot.zid()) not in " ".join(found)


@pytest.mark.parametrize(
    ("refusal", "expected"),
    [(None, False), (PermissionError("Operation not permitted"), True), (OSError("Network is unreachable"), False)],
)
def test_rules_of_the_firewall_show_by_a_packet_that_is_not_permitted(monkeypatch, refusal, expected):
    """Where they are in force there is no warning of what they prevent."""

    class Probe(socket.socket):
        def sendto(self, *_):
            if refusal is not None:
                raise refusal

    monkeypatch.setattr("proxy.bridge.lookout.socket.socket", Probe)
    assert guarded() is expected
    lookout = Lookout("auto", [])
    lookout._found = {"the Zenoh peer 1": "tcp/10.0.0.1:1"}
    assert bool(lookout.warnings()) is not expected


@pytest.mark.parametrize(
    ("locator", "expected"),
    [
        ("tcp/127.0.0.1:7447", False),
        ("tcp/[::1]:7447", False),
        ("tcp/192.0.2.1:7447", False),
        ("unixsock-stream//tmp/a", False),
        ("tcp/a.name.invalid:1", False),
    ],
)
def test_addresses_of_others_and_of_loopback_are_not_ours(locator, expected):
    """Nor is anything that is no address."""
    assert on_this_host(locator) is expected
    assert on_this_host(f"tcp/{outside()}:7447#iface=wlan0")
