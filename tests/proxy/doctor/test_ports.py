"""Whether ports are free, on real sockets."""

import os
import socket
from contextlib import ExitStack
from pathlib import Path

import pytest

from proxy.doctor.finding import State
from proxy.doctor.ports import ports
from tests.ports import free_port


@pytest.fixture
def taken():
    """Take a port; return its number."""
    with ExitStack() as opened:

        def take(kind):
            held = opened.enter_context(socket.socket(type=kind))
            held.bind(("127.0.0.1", free_port()))
            if kind == socket.SOCK_STREAM:
                held.listen()
            return held.getsockname()[1]

        yield take


def look(endpoint, *ours):
    (found,) = ports([endpoint], ours)
    assert found.check == "port"
    return found.state, found.text


@pytest.mark.parametrize("protocol", ["tcp", "tls", "ws", "udp", "quic"])
def test_a_port_that_nobody_has_is_free(protocol):
    """Of TCP and of UDP."""
    endpoint = f"{protocol}/127.0.0.1:{free_port()}#iface=lo"
    assert look(endpoint) == (State.FINE, f"{endpoint}: free")


def test_another_process_is_named(taken):
    """With its number, as far as this user may see it."""
    port = taken(socket.SOCK_STREAM)
    state, text = look(f"tcp/0.0.0.0:{port}")
    name = Path("/proc/self/comm").read_text().strip()
    assert state == State.FINDING
    assert f"another process, {name} (pid {os.getpid()}), has this port" in text


def test_a_process_is_named_that_closes_a_file_meanwhile(taken, monkeypatch):
    """Whoever opens and closes many is not overlooked."""
    port, readlink, gone = taken(socket.SOCK_STREAM), os.readlink, []

    def closing(file):
        if Path(file).parent.parent.name == str(os.getpid()) and not gone:
            gone.append(file)
            raise FileNotFoundError(file)
        return readlink(file)

    monkeypatch.setattr(os, "readlink", closing)
    assert f"(pid {os.getpid()})" in look(f"tcp/0.0.0.0:{port}")[1]
    assert gone


def test_a_port_of_udp_may_be_taken_too(taken):
    """And that of TCP with the same number is another one."""
    port = taken(socket.SOCK_DGRAM)
    assert look(f"quic/127.0.0.1:{port}")[0] == State.FINDING
    assert look(f"tls/127.0.0.1:{port}")[0] == State.FINE


def test_the_daemon_of_this_robot_may_have_it(taken):
    """However it wrote the address."""
    port = taken(socket.SOCK_STREAM)
    state, text = look(f"tcp/0.0.0.0:{port}", "unixsock-stream/x", f"tcp/127.0.0.1:{port}")
    assert (state, text.endswith("the daemon of this robot listens there")) == (State.FINE, True)


def test_an_address_of_another_host_is_a_finding():
    """As is a name that nobody knows."""
    state, text = look(f"tcp/192.0.2.1:{free_port()}")
    assert (state, "this host has no such address" in text) == (State.FINDING, True)
    state, text = look(f"tcp/[fe80::1]:{free_port()}")
    assert (state, "nobody can listen there" in text or "this host has no such address" in text) == (
        State.FINDING,
        True,
    )
    state, text = look(f"tcp/nobody.invalid:{free_port()}")
    assert (state, "the host has no address here" in text) == (State.FINDING, True)


def test_what_is_no_port_is_not_looked_at():
    """Nor port 0, which is any that is free."""
    assert not list(ports(["unixsock-stream//run/x", "tcp/127.0.0.1:0"], ()))
