"""The unit of the service, with the test in systemd's part."""

import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from proxy import exit_codes
from proxy.log import NEWS_AT_ONCE, PERIOD
from proxy.tuning import TUNING
from tests.ports import free_port

ROOT = Path(__file__).parents[2]
UNIT = ROOT / "deploy" / "systemd" / "sendworthy.service"


def settings(unit=UNIT):
    """All settings of a unit by name, each with its values in order."""
    found = {}
    for line in unit.read_text().splitlines():
        if re.match(r"[A-Z]\w+=", line):
            name, value = line.split("=", 1)
            found.setdefault(name, []).append(value)
    return found


class Service:
    """Starts and reloads the daemon as the unit says, in a place of its own instead of /etc/sendworthy."""

    def __init__(self, folder):
        self._unit = settings()
        self._folder = folder
        self.config = shutil.copy(ROOT / "deploy" / "sendworthy.toml", folder)
        self.specs = folder / "specs.d" / "surveillance.toml"
        self.specs.parent.mkdir()
        shutil.copy(ROOT / "utility_specs" / "surveillance.toml", self.specs)
        (self._file,) = (value.removeprefix("-") for value in self._unit["EnvironmentFile"])
        self._path(self._file).write_text(
            f'SENDWORTHY_APP__LISTEN=["tcp/127.0.0.1:{free_port()}"]\nSENDWORTHY_MESH__LISTEN=[]\n'
            "SENDWORTHY_MESH__SCOUTING=false\nSENDWORTHY_ROBOT=r1\n"
        )
        self._systemd = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._systemd.bind(str(folder / "notify"))
        self._systemd.settimeout(20.0)
        self.process = None

    def _path(self, text):
        return self._folder / Path(text).relative_to("/etc/sendworthy")

    def _command(self, line):
        line = line.replace("/etc/sendworthy/", f"{self._folder}/").replace(
            "$MAINPID", str(self.process and self.process.pid)
        )
        program, *words = shlex.split(line)
        return [sys.executable, "-m", "proxy.cli", *words] if program.endswith("/sendworthy") else [program, *words]

    def _environment(self):
        own = dict(line.split("=", 1) for line in self._path(self._file).read_text().splitlines())
        microseconds = int(float(self._unit["WatchdogSec"][0]) * 1e6)
        notify = {"NOTIFY_SOCKET": self._systemd.getsockname(), "WATCHDOG_USEC": str(microseconds)}
        return os.environ | own | notify

    def start(self):
        (line,) = self._unit["ExecStart"]
        self.process = subprocess.Popen(
            self._command(line), cwd=ROOT, env=self._environment(), stderr=subprocess.PIPE, text=True
        )

    def reload(self):
        """Run the commands one after the other, up to one that fails; return what that says."""
        for line in self._unit["ExecReload"]:
            done = subprocess.run(
                self._command(line), cwd=ROOT, env=self._environment(), check=False, capture_output=True, text=True
            )
            if done.returncode:
                return done.stdout + done.stderr
        return ""

    def told(self):
        """The next thing that systemd hears, but for signs of life."""
        while (heard := self._systemd.recv(4096).decode()) == "WATCHDOG=1":
            continue
        return heard

    def alive(self):
        """Wait for a sign of life."""
        return self._systemd.recv(4096).decode() == "WATCHDOG=1"

    def end(self):
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
        self._systemd.close()


@pytest.fixture
def service(tmp_path):
    service = Service(tmp_path)
    yield service
    service.end()


@pytest.mark.full
def test_the_service_lives_as_systemd_wants_it(service):
    """It is ready, alive, reloads what is right and refuses what is not, and stops."""
    service.start()
    ready = service.told()
    assert ready.startswith("READY=1\nSTATUS=sendworthy ")
    assert "robot r1, " in ready
    assert service.alive()
    before = service.specs.read_text()
    service.specs.write_text(before.replace("weight = 1.0", "weight = 2.0"))
    assert service.reload() == ""
    assert service.told().startswith("RELOADING=1\nMONOTONIC_USEC=")
    assert service.told() not in ("", ready)
    service.specs.write_text(before.replace('kind = "throughput"', 'kind = "thruput"'))
    assert f"{service.specs}:" in service.reload()
    service.process.send_signal(signal.SIGTERM)
    assert service.told() == "STOPPING=1"
    assert service.process.wait(float(settings()["TimeoutStopSec"][0])) == exit_codes.OK


@pytest.mark.parametrize("unit", [UNIT, ROOT / "deploy" / "apps" / "namespace.conf"], ids=lambda unit: unit.name)
def test_systemd_never_gives_up(unit):
    """By default a service stays failed that ended five times within 10 s; with RestartSec=100ms that is soon so."""
    assert settings(unit)["StartLimitIntervalSec"] == ["0"]


def test_systemd_takes_the_unit(tmp_path):
    """It knows every key, in the section in which it stands."""
    if shutil.which("systemd-analyze") is None:
        pytest.skip("needs systemd-analyze")
    unit = UNIT.read_text().replace("/opt/sendworthy/bin/sendworthy", sys.executable)
    (tmp_path / UNIT.name).write_text(unit)
    found = subprocess.run(
        ["systemd-analyze", "verify", UNIT.name],
        cwd=tmp_path,
        env={"SYSTEMD_UNIT_PATH": f"{tmp_path}:", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.returncode, found.stderr) == (0, "")


def test_what_is_wrong_from_the_start_is_not_tried_again(service):
    """The exit code is the one after which the unit is not restarted."""
    Path(service.config).write_text("mode = 'fast'\n")
    service.start()
    code = service.process.wait(20.0)
    assert settings()["RestartPreventExitStatus"] == [str(code)]


def test_decoders_of_images_do_not_fill_the_journal():
    """They write to standard error by themselves; what the daemon says as often as it may has room beside them."""
    assert settings()["LogRateLimitIntervalSec"] == [f"{PERIOD:g}"]
    assert settings()["LogRateLimitBurst"] == [str(3 * NEWS_AT_ONCE)]


def test_the_daemon_comes_before_what_computes():
    """The unit gives it the place that it would take itself where it may, and its group the weight for it."""
    assert settings()["Nice"] == [str(TUNING.niceness)]
    assert int(settings()["CPUWeight"][0]) > 100
