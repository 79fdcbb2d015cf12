"""What systemd hears, with a socket in its place."""

import errno
import os
import socket
from contextlib import closing

import pytest

from proxy.service import Service


@pytest.fixture
def systemd(tmp_path):
    """Where systemd listens."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "notify"))
        listener.settimeout(5.0)
        yield listener


@pytest.fixture
def told_by(stack):
    """A service in an environment."""
    return lambda environ: stack.enter_context(closing(Service(environ)))


def heard(listener):
    return listener.recv(4096).decode().splitlines()


def test_everything_is_told_in_systemds_words(systemd, told_by):
    """Ready with a status line, reloading with the time, alive, stopping."""
    service = told_by({"NOTIFY_SOCKET": systemd.getsockname()})
    service.ready("robot r1")
    assert heard(systemd) == ["READY=1", "STATUS=robot r1"]
    service.reloading()
    reloading, since = heard(systemd)
    assert reloading == "RELOADING=1"
    assert int(since.removeprefix("MONOTONIC_USEC=")) > 0
    service.alive()
    assert heard(systemd) == ["WATCHDOG=1"]
    service.stopping()
    assert heard(systemd) == ["STOPPING=1"]


def test_a_daemon_without_descriptors_is_alive(systemd, monkeypatch, told_by):
    """systemd would end it, while it works."""
    service = told_by({"NOTIFY_SOCKET": systemd.getsockname()})

    def none_left(*_, **__):
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr(socket, "socket", none_left)
    service.alive()
    assert heard(systemd) == ["WATCHDOG=1"]
    service.close()
    service.alive()
    systemd.setblocking(False)
    with pytest.raises(BlockingIOError):
        systemd.recv(1)


def test_names_that_are_no_text_are_told_as_far_as_they_are(systemd, told_by):
    """A folder may have any name."""
    told_by({"NOTIFY_SOCKET": systemd.getsockname()}).ready("specs in caf\udce9")
    assert heard(systemd) == ["READY=1", "STATUS=specs in caf?"]


def test_an_abstract_address_is_understood(told_by):
    """systemd in containers writes one with an @ in front."""
    name = f"sendworthy-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(f"\0{name}")
        listener.settimeout(5.0)
        told_by({"NOTIFY_SOCKET": f"@{name}"}).alive()
        assert heard(listener) == ["WATCHDOG=1"]


def test_without_systemd_nothing_is_told(systemd, told_by):
    """In a terminal there is nobody to tell."""
    told_by({}).ready("robot r1")
    systemd.setblocking(False)
    with pytest.raises(BlockingIOError):
        systemd.recv(1)


def test_a_deaf_systemd_is_no_obstacle(tmp_path, caplog, told_by):
    """One line in the log, and the daemon goes on."""
    told_by({"NOTIFY_SOCKET": str(tmp_path / "gone")}).ready("robot r1")
    assert f"systemd does not hear us at {tmp_path}/gone: No such file or directory" in caplog.text


@pytest.mark.parametrize(
    ("environ", "watchdog"),
    [
        ({}, None),
        ({"WATCHDOG_USEC": "30000000"}, 30.0),
        ({"WATCHDOG_USEC": "30000000", "WATCHDOG_PID": str(os.getpid())}, 30.0),
        ({"WATCHDOG_USEC": "30000000", "WATCHDOG_PID": "1"}, None),
        ({"WATCHDOG_USEC": "0"}, None),
        ({"WATCHDOG_USEC": "soon"}, None),
    ],
)
def test_the_watchdog_is_fed_when_it_is_ours(environ, watchdog, told_by):
    """Its time is in microseconds; it may be meant for another process, or be off."""
    assert told_by({"NOTIFY_SOCKET": "/run/notify", **environ}).watchdog == watchdog


def test_without_a_socket_there_is_no_watchdog(told_by):
    """Nobody would hear that we are alive."""
    assert told_by({"WATCHDOG_USEC": "30000000"}).watchdog is None
