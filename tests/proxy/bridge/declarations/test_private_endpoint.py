"""Private places are removed, whatever ends the process."""

import os
import signal
import socket
import subprocess
import sys
import tempfile

import pytest

from proxy.bridge.declarations.private_endpoint import PrivateEndpoint
from proxy.bridge.sessions import zenoh_session
from proxy.errors import SessionError
from tests.proxy.nodes import closing

HOLD = """
import sys
from proxy.bridge.declarations.private_endpoint import PrivateEndpoint
endpoint = PrivateEndpoint()
print("open", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def places(tmp_path, monkeypatch):
    """The folder in which all places are."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_a_closed_endpoint_leaves_nothing(places):
    """Closing removes the folder with all that is in it."""
    endpoint = PrivateEndpoint()
    endpoint.main.write_text("")
    assert endpoint.main.parent.parent == places
    endpoint.close()
    assert not list(places.iterdir())


def test_the_place_of_a_killed_process_is_removed_and_that_of_a_living_one_is_not(places):
    """The next endpoint sweeps what nobody holds any more."""
    environment = os.environ | {"TMPDIR": str(places)}
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        assert other.stdout.readline() == b"open\n"
        (held,) = places.iterdir()
        PrivateEndpoint().close()
        assert list(places.iterdir()) == [held]
        other.send_signal(signal.SIGKILL)
        other.wait()
        assert held.exists()
        endpoint = PrivateEndpoint()
        assert list(places.iterdir()) == [endpoint.main.parent]
        endpoint.close()


def test_what_is_not_ours_is_left_alone(places):
    """A folder of the same name without a lock, or one that cannot be read, stops nothing and stays."""
    alien = places / "sendworthy-private-alien"
    alien.mkdir()
    PrivateEndpoint().close()
    assert list(places.iterdir()) == [alien]


@pytest.mark.parametrize("given", [True, False], ids=["of the service", "in memory"])
def test_where_the_disk_takes_no_folder_it_is_elsewhere(places, tmp_path, monkeypatch, given):
    """A robot whose disk is full, or may not be written to, boots with its daemon all the same."""
    monkeypatch.setattr(tempfile, "tempdir", str(places / "full"))
    (folder := tmp_path / "run").mkdir()
    if given:
        monkeypatch.setenv("RUNTIME_DIRECTORY", str(folder))
    else:
        monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
        monkeypatch.setattr("proxy.bridge.declarations.private_endpoint.MEMORY", str(folder))
    endpoint = PrivateEndpoint()
    assert list(folder.iterdir()) == [endpoint.main.parent]
    endpoint.close()
    assert not list(folder.iterdir())


def test_where_no_place_takes_a_folder_one_line_says_so(places, monkeypatch):
    """And what to do."""
    monkeypatch.setattr(tempfile, "tempdir", str(places / "full"))
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    monkeypatch.setattr("proxy.bridge.declarations.private_endpoint.MEMORY", str(places / "neither"))
    with pytest.raises(SessionError, match=r"neither.*; let TMPDIR name a place with room$"):
        PrivateEndpoint()


def test_what_zenoh_announces_leads_there_from_this_process_alone(stack):
    """Another daemon of this machine links elsewhere, however early it hears of the place."""
    endpoint = PrivateEndpoint()
    stack.callback(endpoint.close)
    options = endpoint.added_to({"mode": "peer", "listen": {"endpoints": []}})
    closing(stack, zenoh_session(options | {"scouting": {"multicast": {"enabled": False}}}))
    (announced,) = options["listen"]["endpoints"]
    link = f"import socket; socket.socket(socket.AF_UNIX).connect({announced.removeprefix('unixsock-stream/')!r})"
    other = subprocess.run([sys.executable, "-c", link], capture_output=True, text=True, check=False)
    assert "FileNotFoundError" in other.stderr
    with socket.socket(socket.AF_UNIX) as own:
        own.connect(str(endpoint.main))
