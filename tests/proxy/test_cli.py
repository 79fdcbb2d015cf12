"""The command line: what it knows, how it refuses, what it suggests."""

import errno
import os
import re
import subprocess
import sys
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from unittest.mock import ANY

import pytest

from proxy import cli, exit_codes
from proxy.cli import main
from proxy.commands.client import NoAnswerError, connected
from tests.ports import free_port
from tests.waiting import wait_until

ROOT = Path(__file__).parent.parent.parent


def sendworthy(*arguments, **environ):
    """Run the command line as a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "proxy.cli", *arguments],
        cwd=ROOT,
        env=os.environ | environ,
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )


class EntryPoint:
    """A command that another package brings along."""

    def __init__(self, name, load):
        self.name = name
        self.load = load


@pytest.fixture
def add_on(monkeypatch):
    """Let the command line find a command from elsewhere."""

    def add(name, load):
        monkeypatch.setattr(metadata, "entry_points", lambda group: [EntryPoint(name, load)] if group else [])

    return add


def test_version():
    """The version is that of the package."""
    shown = sendworthy("--version")
    assert (shown.returncode, shown.stdout) == (0, f"sendworthy {metadata.version('sendworthy')}\n")


def test_help_lists_every_command(capsys):
    """The first page names all commands and shows examples."""
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0
    out = capsys.readouterr().out
    for command in cli.BUILT_IN:
        assert re.search(rf"\n    {command}\s", out)
    assert "sendworthy run --config sendworthy.toml" in out


@pytest.mark.parametrize("command", cli.BUILT_IN)
def test_every_command_has_help_with_examples(capsys, command):
    """Nobody has to guess how a command is used."""
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    assert f"examples:\n  sendworthy {command}" in capsys.readouterr().out


def test_run_has_a_flag_for_every_key(capsys):
    """The help of `run` is complete."""
    with pytest.raises(SystemExit):
        main(["run", "--help"])
    out = capsys.readouterr().out
    assert "--planner.iterations VALUE" in out
    assert "--mesh.zenoh VALUE" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "the following arguments are required: COMMAND"),
        (["stauts"], 'unknown command "stauts" (did you mean "status"?)'),
        (["fly"], 'unknown command "fly" (known: "'),
        (
            ["run", "--planner.iteration", "5"],
            "unknown argument --planner.iteration (did you mean --planner.iterations?)",
        ),
        (["config", "--mesh.conect", "x"], "unknown argument --mesh.conect (did you mean --mesh.connect?)"),
        (["run", "--mesh.conect=[]"], "unknown argument --mesh.conect=[] (did you mean --mesh.connect?)"),
        (["run", "sendworthy.toml"], "unknown argument sendworthy.toml (did you mean --config sendworthy.toml?)"),
        (["run", "--robot", "r1", "r2"], "unknown argument r2\n"),
        (["run", "--ap.zenoh.mode", "peer"], "unknown argument --ap.zenoh.mode (did you mean --app.zenoh?)"),
        (["status", "--jsn"], "unknown argument --jsn (did you mean --json?)"),
        (["status", "-json"], "unknown argument -json (did you mean --json?)"),
        (["check", "--confg", "a.toml"], "unknown argument --confg (did you mean --config?)"),
        (["learn", "--second", "3"], "unknown argument --second (did you mean --seconds?)"),
        (["explain", "a", "--spec", "b"], "unknown argument --spec (did you mean --specs?)"),
        (["push"], "the following arguments are required: FILE"),
        (["mode", "enfroce"], 'argument MODE: unknown "enfroce" (did you mean "enforce"?)'),
        (["mode", "on"], 'argument MODE: unknown "on" (known: "pass", "shadow", "enforce")'),
        (
            ["status", "--connect", "localhost"],
            'must be an endpoint like "tcp/192.168.1.2:7500", not "localhost"',
        ),
        (["status", "--robot", "a/b"], 'must be one chunk of a key, without /: "a/b"'),
        (["--verison"], "unknown argument --verison (did you mean --version?)"),
        (["--config", "a.toml", "run"], "unknown argument --config: flags follow the command"),
        (["--robot", "r1", "status"], "unknown argument --robot: flags follow the command"),
        (["--robot", "r1"], "unknown argument --robot\n"),
    ],
)
def test_a_wrong_command_line_is_refused(capsys, arguments, message):
    """Exit code 2, what is wrong, and what was probably meant."""
    with pytest.raises(SystemExit) as left:
        main(arguments)
    assert left.value.code == exit_codes.USAGE
    assert message in capsys.readouterr().err


def test_every_key_of_zenoh_is_a_flag(tmp_path):
    """Like every other key; a mistake in one is named by its flag."""
    file = tmp_path / "sendworthy.toml"
    file.write_text('mode = "on"\n')
    flags = (
        "--app.zenoh.transport.unicast.max_sessions",
        "many",
        "--mesh.zenoh.transport.link.tx.lease=5000",
        "--app.zenoh.mod",
    )
    ended = sendworthy("run", "--config", str(file), *flags, "--mesh.zenoh.mode", "on", "--planner.horizon", "5")
    assert ended.returncode == exit_codes.CONFIG
    assert [line.partition(": ")[::2] for line in ended.stderr.splitlines()] == [
        (f"{file}:1", 'mode: unknown "on" (known: "pass", "shadow", "enforce")'),
        ("--app.zenoh.transport.unicast.max_sessions", ANY),
        ("--app.zenoh.mod", 'unknown key of Zenoh (did you mean "mode"?)'),
        ("--mesh.zenoh.mode", ANY),
    ]


def test_commands_from_elsewhere_are_found(add_on, capsys):
    """A command of another package works like ours."""

    def command(subparsers):
        parser = subparsers.add_parser("dance", help="dance")
        parser.add_argument("--turns", type=int, default=1)
        parser.set_defaults(run=lambda arguments: print("dancing" * arguments.turns) or 7)

    add_on("dance", lambda: command)
    assert main(["dance", "--turns", "2"]) == 7
    assert capsys.readouterr().out == "dancingdancing\n"


def test_a_broken_command_from_elsewhere_fails_alone(add_on, capsys):
    """It is named when it is asked for, and in nobody's way otherwise."""

    def load():
        raise ImportError("No module named 'scipy'")

    add_on("dance", load)
    assert main(["dance"]) == exit_codes.FAILED
    assert capsys.readouterr().err == ("sendworthy: the command \"dance\" cannot be loaded: No module named 'scipy'\n")
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0
    assert "dance" not in capsys.readouterr().out


def raising(error):
    """Return a function that raises, whatever it gets."""

    def fail(*_):
        raise error

    return fail


def command_that(run):
    """Return what loads a command `wait` that runs so."""
    return lambda: lambda subparsers: subparsers.add_parser("wait").set_defaults(run=run)


@pytest.mark.parametrize("load", [raising(KeyboardInterrupt), command_that(raising(KeyboardInterrupt))])
def test_ctrl_c_is_no_traceback(add_on, load):
    """Who interrupts a command knows that it was interrupted, also while it is loaded."""
    add_on("wait", load)
    assert main(["wait"]) == exit_codes.INTERRUPTED


@pytest.mark.full
@pytest.mark.parametrize("words", [["check", "utility_specs/surveillance.toml"], ["schema"], ["--version"]])
def test_output_without_room_is_told(tmp_path, words):
    """A full disk, or a file that may not be larger."""
    limited = ["sh", "-c", 'ulimit -f 0; exec "$@" > "$0"', str(tmp_path / "out")]
    command = [*limited, sys.executable, "-B", "-m", "proxy.cli", *words]
    buffered = os.environ | {"PYTHONUNBUFFERED": ""}  # else argparse writes the version, and passes over what fails
    ended = subprocess.run(command, cwd=ROOT, env=buffered, capture_output=True, text=True, timeout=30, check=False)
    said = ended.stderr.splitlines()[0]  # measuring coverage finds no room either, and says so at the end
    assert (ended.returncode, said) == (exit_codes.FAILED, "sendworthy: cannot write: File too large")


def test_a_file_without_room_is_named(add_on, capfd):
    """Where the system says which it is; other errors are mistakes of ours."""
    add_on("wait", command_that(raising(OSError(errno.ENOSPC, "No space left on device", "x"))))
    stdout = os.dup(sys.stdout.fileno())
    try:
        assert main(["wait"]) == exit_codes.FAILED
    finally:
        os.dup2(stdout, sys.stdout.fileno())
        os.close(stdout)
    assert capfd.readouterr().err == "sendworthy: cannot write x: No space left on device\n"
    add_on("wait", command_that(raising(OSError(errno.ENOENT, "No such file or directory"))))
    with pytest.raises(FileNotFoundError):
        main(["wait"])


def test_a_reader_that_leaves_is_no_error(tmp_path):
    """`sendworthy … | head -1` ends quietly."""
    program = (
        "import sys; from importlib import metadata; from proxy import cli\n"
        "class Entry:\n"
        "    name = 'say'\n"
        "    def load(self): return lambda parsers: parsers.add_parser('say').set_defaults(run=run)\n"
        "def run(_):\n"
        "    for _ in range(100000): print('x' * 100)\n"
        "metadata.entry_points = lambda group: [Entry()]\n"
        "sys.exit(cli.main(['say']))"
    )
    errors = tmp_path / "errors"
    with errors.open("w") as stderr:
        writer = subprocess.Popen(
            [sys.executable, "-c", program], cwd=ROOT, stdout=subprocess.PIPE, stderr=stderr, text=True
        )
        assert writer.stdout.readline() == "x" * 100 + "\n"
        writer.stdout.close()
        assert writer.wait(30) == exit_codes.OK
    assert errors.read_text() == ""


SPEC = """\
[[information_type]]
name = "カメラ"
keys = ["robot/*/camera"]
utility = { kind = "video" }
"""


def test_what_the_output_cannot_show_is_replaced(tmp_path):
    """Names and keys may be of a script that the terminal does not know."""
    (tmp_path / "specs.toml").write_text(SPEC)
    shown = sendworthy("check", str(tmp_path), PYTHONUTF8="0", PYTHONIOENCODING="ascii")
    assert (shown.returncode, shown.stderr) == (exit_codes.OK, "")
    assert 'information_type "???": robot/*/camera' in shown.stdout


def test_who_closed_the_output_gets_the_exit_code(tmp_path):
    """As a script that only wants to know whether specs are right."""
    (tmp_path / "specs.toml").write_text(SPEC)
    command = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "proxy.cli", "check", str(tmp_path)]
    ended = subprocess.run(command, cwd=ROOT, stderr=subprocess.PIPE, text=True, timeout=30, check=False)
    assert (ended.returncode, ended.stderr) == (exit_codes.OK, "")


@pytest.mark.full
def test_a_daemon_runs_though_who_started_it_closed_all_it_could_write_to():
    """Its log goes nowhere, and no socket takes the place of that."""
    flags = ("--app.listen", f'["{(endpoint := f"tcp/127.0.0.1:{free_port()}")}"]', "--mesh.listen", "[]")
    command = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", sys.executable, "-m", "proxy.cli", "run", *flags]
    process = subprocess.Popen([*command, "--mesh.scouting", "false", "--robot", "r1"], cwd=ROOT)
    try:
        wait_until(
            lambda: process.poll() is not None or answers(endpoint),
            what="an answer of the daemon",
        )
        opened = {Path(f"/proc/{process.pid}/fd/{number}").readlink() for number in range(3)}
        assert opened == {Path(os.devnull)}
    finally:
        process.terminate()
    assert process.wait(30) == exit_codes.OK


def answers(endpoint):
    """Whether a daemon tells its status."""
    with suppress(NoAnswerError), connected(endpoint) as client:
        return bool(client.status(None))
    return False


def test_a_bad_configuration_is_named_with_file_line_and_key(tmp_path):
    """The process exits 78 and says where to look."""
    file = tmp_path / "sendworthy.toml"
    file.write_text('robot = "r1"\n[mesh]\nscouting = "maybe"\n')
    ended = sendworthy("run", "--config", str(file), "--planner.horizon", "0", SENDWORTHY_MODE="on")
    assert (ended.returncode, ended.stdout) == (exit_codes.CONFIG, "")
    assert ended.stderr.splitlines() == [
        f'{file}:3: mesh.scouting: must be true or false, not "maybe"',
        'SENDWORTHY_MODE: mode: unknown "on" (known: "pass", "shadow", "enforce")',
        "--planner.horizon: must be at least 1, not 0",
    ]
