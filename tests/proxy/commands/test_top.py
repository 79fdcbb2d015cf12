"""`sendworthy top` against running daemons, in a terminal."""

import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
import threading

import pytest

import proxy.top
from proxy import exit_codes
from proxy.cli import main
from proxy.top.asking import Asking
from tests.daemons import ROOT, specs_file
from tests.ports import free_port
from tests.waiting import wait_until


class Screen:
    """`sendworthy top` in a terminal of a size; `seen` is all that it wrote."""

    def __init__(self, *arguments, width=80, height=24):
        self.person, program = pty.openpty()
        self.resize(width, height)
        self.modes = termios.tcgetattr(self.person)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "proxy.cli", "top", *arguments],
            cwd=ROOT,
            env={**os.environ, "TERM": "xterm"},
            stdin=program,
            stdout=program,
            stderr=program,
            start_new_session=True,
        )
        self._program = program
        self.seen = ""
        self._closing = False
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def resize(self, width, height):
        """What a terminal does when its window changes."""
        fcntl.ioctl(self.person, termios.TIOCSWINSZ, struct.pack("HHHH", height, width, 0, 0))
        if hasattr(self, "process"):
            self.process.send_signal(signal.SIGWINCH)

    def press(self, keys):
        """Type."""
        self.seen = ""
        os.write(self.person, keys.encode())

    def shows(self, text):
        """Wait until it is seen."""
        wait_until(lambda: text in self.seen, what=f"{text!r} on the screen, which shows {self.seen[-3000:]!r}")

    def end(self):
        """Wait for the end; return the exit code, and whether the terminal is as it was."""
        code = self.process.wait(60)
        return code, termios.tcgetattr(self.person) == self.modes

    def close(self):
        """Whatever happened."""
        self.process.kill()
        self.process.wait()
        self._closing = True
        self._reader.join()  # before its descriptor is another terminal's
        for descriptor in (self.person, self._program):
            os.close(descriptor)

    def _read(self):
        while not self._closing:
            ready, _, _ = select.select([self.person], [], [], 0.1)
            if ready:
                text = os.read(self.person, 65536).decode(errors="replace")
                self.seen += text


@pytest.fixture
def screen():
    """Open screens; they are closed after the test."""
    opened = []

    def open_one(*arguments, **options):
        opened.append(Screen(*arguments, **options))
        return opened[-1]

    yield open_one
    for each in opened:
        each.close()


def test_a_terminal_that_does_not_say_how_large_it_is_shows_it_all_the_same(daemon, screen):
    """As a serial console."""
    top = screen("--connect", daemon.endpoint, "--interval", "0.2", width=0, height=0)
    top.shows("robot r1   mode ")
    top.press("q")
    assert top.end() == (0, True)


def test_every_key_does_what_it_says(daemon, screen):
    """The terminal is given back when it quits."""
    top = screen("--connect", daemon.endpoint, "--interval", "0.2")
    top.shows("robot r1   mode ")
    top.shows("throughput  [")
    for key, text in (
        ("f", "1 robots"),
        ("\r", "robot r1"),
        ("s", "by made"),
        ("r", "turned"),
        ("/cam", "only rows with: cam_"),
        ("\r", "only 'cam'"),
        ("\x1b", "by made, turned   q"),
        ("?", "any other key: back"),
        ("x", "by made"),
    ):
        top.press(key)
        top.shows(text)
    top.press("q")
    assert top.end() == (exit_codes.OK, True)


def test_a_window_that_changes_its_size_is_drawn_anew(daemon, screen):
    """At once, and not when the daemon is asked next."""
    top = screen("--connect", daemon.endpoint, "--interval", "3600")
    top.shows("specs ")
    top.seen = ""
    top.resize(160, 40)
    top.shows("transport unicast")


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.full), signal.SIGINT])
def test_the_terminal_is_given_back_whatever_ends_it(daemon, screen, number):
    """Whoever is left in a terminal without echo cannot even see what he types."""
    top = screen("--connect", daemon.endpoint)
    top.shows("robot r1")
    top.process.send_signal(number)
    code, same = top.end()
    assert code == (exit_codes.INTERRUPTED if number == signal.SIGINT else 128 + number)
    assert same


@pytest.mark.full
def test_a_daemon_may_go_and_come_back(start, screen, tmp_path):
    """What it said last stays, keys are heard meanwhile, and it goes on by itself."""
    arguments = ("--robot", "r1", "--specs.path", str(specs_file(tmp_path)))
    first = start(*arguments)
    first.wait_for("sendworthy ")
    top = screen("--connect", first.endpoint, "--interval", "0.2")
    top.shows("robot r1")
    first.end(signal.SIGKILL)
    top.shows("no daemon answers")
    top.press("f")
    top.shows("1 robots")
    again = start(*arguments, endpoint=first.endpoint)
    again.wait_for("sendworthy ")
    top.press("f")

    def well():
        top.press("?")
        top.press("x")
        wait_until(lambda: "by not sent" in top.seen, what="an answer to keys")
        return "no daemon" not in top.seen

    wait_until(well, what="the daemon to be shown again")


def test_what_is_no_terminal_gets_one_picture(daemon, capsys):
    """With rates, for which it is asked twice."""
    assert main(["top", "--connect", daemon.endpoint, "--interval", "0.1"]) == exit_codes.OK
    out = capsys.readouterr().out
    assert out.startswith("robot r1   mode ")
    assert "samples   0.0/s made" in out
    assert "q quit" not in out
    assert main(["top", "--once", "--fleet", "--connect", daemon.endpoint, "--interval", "0.1"]) == exit_codes.OK
    assert capsys.readouterr().out.startswith("1 robots\n")


def test_who_reads_no_further_makes_it_no_failure(daemon):
    """Such as `sendworthy top --once | head -1`: it ends as every command does."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "proxy.cli", "top", "--once", "--interval", "0.1", "--connect", daemon.endpoint]
    with os.fdopen(writing, "wb") as pipe:
        assert subprocess.run(command, cwd=ROOT, stdout=pipe, check=False, timeout=60).returncode == exit_codes.OK


def test_a_robot_that_is_not_there_is_named(daemon, capsys):
    """And the command fails."""
    assert (
        main(["top", "--once", "--robot", "zz", "--connect", daemon.endpoint, "--interval", "0.1"]) == exit_codes.FAILED
    )
    assert "robot zz is not known; there are r1" in capsys.readouterr().out


def test_without_a_daemon_the_message_says_so(capsys):
    """And the command fails."""
    where = f"tcp/127.0.0.1:{free_port()}"
    assert main(["top", "--once", "--connect", where]) == exit_codes.FAILED
    assert f"no daemon answers at {where}" in capsys.readouterr().out


@pytest.mark.parametrize("told", ["[]", '{"robot":"r1","uptime":"x"}'])
def test_what_is_no_status_is_shown_as_what_is_no_daemon(stand_in, capsys, told):
    """One picture, and a failure; nobody waits for ever."""

    def answer(query):
        query.reply("@sendworthy/r1/status", told)
        query.drop()

    where = stand_in({"@sendworthy/*/status": answer})
    assert main(["top", "--once", "--interval", "0.1", "--connect", where]) == exit_codes.FAILED
    assert f"what answers at {where} is no daemon of this version" in capsys.readouterr().out
    assert main(["status", "--connect", where]) == exit_codes.FAILED
    assert f"what answers at {where} is no daemon of this version" in capsys.readouterr().err


def test_a_stranger_ends_no_asking(stand_in):
    """Behind what is no status there may come one."""
    told = ['{"robot":"r1","zid":"a","uptime":1.0}']

    def answer(query):
        query.reply("@sendworthy/r1/status", told[0])
        query.drop()

    asking = Asking([stand_in({"@sendworthy/*/status": answer})], 0.05, lambda: None)
    asking.start()
    try:
        wait_until(lambda: asking.scene.changes, what="a status")
        told[0] = '{"robot":"r1","zid":"a","uptime":"x"}'
        wait_until(lambda: "is no daemon of this version" in asking.scene.away, what="a stranger")
        told[0] = '{"robot":"r1","zid":"a","uptime":2.0}'
        wait_until(lambda: not asking.scene.away, what="a status again")
        assert asking.scene.changes["a"].now["uptime"] == 2.0
    finally:
        asking.stop()


def test_without_rich_it_says_what_to_install(monkeypatch, capsys):
    """It comes with an extra."""
    monkeypatch.delitem(sys.modules, "proxy.top.screen", raising=False)
    monkeypatch.delattr(proxy.top, "screen", raising=False)
    monkeypatch.setitem(sys.modules, "rich.console", None)
    assert main(["top"]) == exit_codes.FAILED
    assert 'sendworthy top needs the extra "top": pip install "sendworthy[top]"' in capsys.readouterr().err


@pytest.mark.parametrize("interval", ["0", "-1", "nan", "often", "1e9"])
def test_an_interval_that_makes_no_sense_is_refused(interval, capsys):
    """Before anything is asked."""
    with pytest.raises(SystemExit) as left:
        main(["top", f"--interval={interval}"])
    assert left.value.code == exit_codes.USAGE
    assert "must be 0.1 to 3600 seconds" in capsys.readouterr().err
