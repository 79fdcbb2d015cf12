"""`sendworthy record` against a running daemon."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.config_loading import load_config
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from tests.daemons import ROOT, specs_file
from tests.waiting import wait_until


@pytest.fixture
def daemon(start, tmp_path):
    """A daemon whose recordings are in `tmp_path`."""
    running = start(
        *("--robot", "r1", "--specs.path", str(specs_file(tmp_path)), "--record.folder", str(tmp_path / "recordings"))
    )
    running.wait_for("sendworthy ")
    return running


def record(daemon, *flags):
    return main(["record", "--connect", daemon.endpoint, *flags])


def test_it_records_for_a_while(daemon, capsys, tmp_path):
    """It says to where, and how much."""
    assert record(daemon, "--seconds", "0.3") == exit_codes.OK
    begun, ended = capsys.readouterr().out.splitlines()
    (file,) = (tmp_path / "recordings").iterdir()
    assert begun == f"robot r1 records to {file}"
    assert ended.startswith(f"recorded to {file}: ")
    assert ended.endswith(" MB")
    assert RecordingReader(file).start.robot == "r1"


def test_it_may_go_on_without_the_command(daemon, capsys):
    """Until somebody ends it; only one records at a time."""
    assert record(daemon, "--on", "--payloads") == exit_codes.OK
    assert record(daemon) == exit_codes.FAILED
    assert record(daemon, "--off") == exit_codes.OK
    assert record(daemon, "--off") == exit_codes.FAILED
    shown = capsys.readouterr()
    assert shown.out.splitlines()[-1].startswith("recorded to ")
    assert "the daemon refuses: it records already, to " in shown.err
    assert shown.err.endswith("the daemon refuses: it does not record\n")


def test_ctrl_c_ends_it_in_order(daemon, tmp_path):
    """What was recorded is whole."""
    command = [sys.executable, "-m", "proxy.cli", "record", "--connect", daemon.endpoint]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline().startswith("robot r1 records to ")
    os.kill(process.pid, signal.SIGINT)
    shown, _ = process.communicate(timeout=60)
    assert process.returncode == exit_codes.OK
    assert shown.startswith("recorded to ")
    reader = RecordingReader(next((tmp_path / "recordings").iterdir()))
    list(reader)
    assert not reader.problems


@pytest.mark.full
def test_it_ends_where_nobody_reads_what_it_prints(daemon, capsys):
    """A pipe that is closed: the daemon would record until its folder is full."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "proxy.cli", "record", "--connect", daemon.endpoint]
    process = subprocess.Popen(command, cwd=ROOT, stdout=writing)
    os.close(writing)
    process.wait(timeout=60)
    assert record(daemon, "--off") == exit_codes.FAILED
    assert capsys.readouterr().err == "sendworthy record: the daemon refuses: it does not record\n"


def test_a_daemon_that_cannot_record_is_told(start, tmp_path, capsys):
    """The reason is in the message, and nothing goes on."""
    (tmp_path / "file").write_text("")
    running = start("--robot", "r1", "--record.folder", str(tmp_path / "file"))
    running.wait_for("sendworthy ")
    assert record(running) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy record: the daemon cannot record: {tmp_path}/file: File exists\n"
    assert record(running, "--off") == exit_codes.FAILED


@pytest.mark.full
def test_a_daemon_that_is_killed_leaves_what_it_recorded(start, tmp_path):
    """The file is read as far as it goes."""
    folder = tmp_path / "recordings"
    running = start("--robot", "r1", "--record.folder", str(folder), "--record.on", "true")
    running.wait_for("sendworthy ")

    def events():
        with suppress(RecordingError):  # it is empty at first
            return len(list(RecordingReader(next(folder.iterdir())))) > 3
        return False

    wait_until(events, what="some events in the file")
    running.process.kill()
    running.process.wait()
    reader = RecordingReader(next(folder.iterdir()))
    assert len(list(reader)) > 3
    assert "was not closed" in reader.problems[0]


@pytest.mark.parametrize("told", ["?", "5", "{}", '{"file": "a", "files": "b"}'])
def test_what_answers_strangely_is_told(stand_in, capsys, told):
    """A daemon of another version, or another program."""
    where = stand_in({"@sendworthy/r1/record": lambda query: query.reply("@sendworthy/r1/record", told)})
    assert main(["record", "--off", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy record: what answers at {where} is no daemon of this version\n"


@pytest.mark.parametrize("seconds", ["0", "-1", "soon", "inf"])
def test_seconds_are_above_0(seconds, capsys):
    """Nothing is asked of a daemon."""
    with pytest.raises(SystemExit) as ended:
        main(["record", "--seconds", seconds])
    assert ended.value.code == exit_codes.USAGE
    assert f"{seconds} is not a number above 0" in capsys.readouterr().err


def test_recordings_are_where_a_service_keeps_things(tmp_path):
    """systemd names the folder."""
    file = tmp_path / "sendworthy.toml"
    file.write_text("[record]\non = true\n")
    assert load_config(file, {"STATE_DIRECTORY": "/var/lib/x"}, {}).record.folder == Path("/var/lib/x/recordings")
    assert load_config(file, {}, {}).record.folder == tmp_path / "recordings"
    assert load_config(file, {}, {"record.folder": "here"}).record.folder == Path("here")
