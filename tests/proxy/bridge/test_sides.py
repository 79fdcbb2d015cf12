"""All sessions of a daemon, opened and closed together."""

import tempfile
from contextlib import ExitStack

import pytest

from proxy.bridge.sides import open_sides
from proxy.config import AppConfig, MeshConfig
from proxy.errors import PortInUseError
from tests.proxy.nodes import closing, free_endpoint, plain_session


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
    """A user who replaces `listen` in `[app.zenoh]` keeps the voice working."""
    endpoint = free_endpoint()
    app = AppConfig(listen=(free_endpoint(),), zenoh={"listen": {"endpoints": [endpoint]}})
    opened = open_sides(app, MeshConfig(listen=(free_endpoint(),), scouting=False), stack)
    closing(stack, plain_session("client", connect=(endpoint,)))
    assert str(opened.apps.session.zid()) in {str(zid) for zid in opened.app.info.routers_zid()}
