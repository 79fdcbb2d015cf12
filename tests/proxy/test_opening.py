"""Sessions open before most of the daemon is imported."""

import subprocess
import sys

import pytest

from proxy.config import AppConfig, Config, MeshConfig
from proxy.errors import PortInUseError
from proxy.opening import Opening
from tests.proxy.nodes import free_endpoint, plain_session


def opened(endpoint):
    mesh = MeshConfig(listen=(), scouting=False)
    return Opening(Config(robot="r1", app=AppConfig(listen=(endpoint,)), mesh=mesh))


def test_sessions_open_without_the_core():
    """It is imported meanwhile, and so is the rest of the bridge."""
    program = "import sys, proxy.opening; print(sorted(sys.modules))"
    names = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert "'proxy.bridge.sides'" in names
    for late in ("proxy.core.core", "proxy.bridge.bridge", "proxy.daemon"):
        assert f"'{late}'" not in names


def test_what_was_opened_is_closed_by_whoever_has_it():
    """Then the port is free; before, nobody else can have it."""
    endpoint = free_endpoint()
    with opened(endpoint).closing, pytest.raises(PortInUseError):
        opened(endpoint)
    plain_session("router", listen=(endpoint,)).close()
