"""All sessions of a daemon, opened and closed together."""

import os
import stat
import tempfile
from contextlib import ExitStack
from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import broadcast
from proxy.bridge.sides import open_sides
from proxy.bridge.tuning import TUNING
from proxy.config import AppConfig, MeshConfig
from proxy.errors import PortInUseError
from tests.ports import free_port
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_nothing_is_left_when_one_session_cannot_be_opened(stack, tmp_path, monkeypatch):
    """A mesh port in use closes the app side again: its port is free and its folder gone."""
    app, taken = free_endpoint(), free_endpoint()
    closing(stack, plain_session("peer", listen=(taken,)))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(PortInUseError, match=r"^mesh\.listen: "), ExitStack() as opening:
        open_sides(AppConfig(listen=(app,)), MeshConfig(listen=(taken,), scouting=False), opening)
    assert not list(tmp_path.iterdir())
    closing(stack, plain_session("router", listen=(app,)))


def test_the_private_listener_is_added_to_what_the_user_merges(stack):
    """A user who replaces `listen` in `[app.zenoh]` keeps the mirror session working."""
    endpoint = free_endpoint()
    app = AppConfig(listen=(free_endpoint(),), zenoh={"listen": {"endpoints": [endpoint]}})
    opened = open_sides(app, MeshConfig(listen=(free_endpoint(),), scouting=False), stack)
    closing(stack, plain_session("client", connect=(endpoint,)))
    assert str(opened.apps.session.zid()) in {str(zid) for zid in opened.app.info.routers_zid()}


def test_applications_of_the_daemons_group_connect_to_a_socket_that_is_a_file(stack, tmp_path):
    """Whatever the mask of the service: with that of the unit only its own user could. Others cannot."""
    path = tmp_path / "zenoh.sock"
    before = os.umask(0o077)
    try:
        app = AppConfig(listen=(f"unixsock-stream/{path}", free_endpoint()))
        open_sides(app, MeshConfig(listen=(free_endpoint(),), scouting=False), stack)
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o760


def test_beside_a_router_of_the_apps_everybody_is_known_for_as_long_as_he_is_there(stack):
    """Apps of either kind at the router and at the daemon: what they declare comes and goes, and is told once."""
    at_router, at_daemon = free_endpoint(), free_endpoint()
    closing(stack, plain_session("router", listen=(at_router,)))
    app = AppConfig(listen=(at_daemon,), connect=(at_router,))
    opened = open_sides(app, MeshConfig(listen=(free_endpoint(),), scouting=False), stack)
    for endpoint in (at_router, at_daemon):
        for mode in ("client", "peer"):
            node = closing(stack, plain_session(mode, connect=(endpoint,)))
            held = [
                node.declare_subscriber("s", zenoh.handlers.Callback(print, indirect=False)),
                node.declare_queryable("q", zenoh.handlers.Callback(print, indirect=False), complete=True),
            ]
            held.append(node.liveliness().declare_token("t"))
            for kind, expected in (("subscriber", {"s": False}), ("queryable", {"q": True}), ("token", {"t": False})):
                wait_until(
                    lambda kind=kind, expected=expected: opened.apps.declared(kind) == expected,
                    what=f"the {kind} of a {mode}",
                )
            node.close()
            for kind in ("subscriber", "queryable", "token"):
                wait_until(lambda kind=kind: not opened.apps.declared(kind), what=f"the end of the {kind} of a {mode}")


def test_a_robot_that_meets_others_at_a_router_joins_a_silent_group_anew(stack, monkeypatch):
    """It is linked to no other robot, yet there may be some; after an error of its radio it was deaf for good."""
    monkeypatch.setattr(broadcast, "TUNING", replace(TUNING, group_check=0.01, group_silent=0.02))
    router, group = free_endpoint(), f"224.0.0.226:{free_port()}"
    mesh = MeshConfig(mode="client", connect=(router,), transport="broadcast", group=group, interface="lo")
    opened = open_sides(AppConfig(listen=(free_endpoint(),)), mesh, stack).data
    assert opened.describe()["reopened"] == 0
    closing(stack, plain_session("router", listen=(router,)))
    wait_until(lambda: opened.describe()["reopened"], what="a session that may hear others")
