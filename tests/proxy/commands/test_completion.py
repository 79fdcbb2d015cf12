"""`sendworthy completion`, in the shells that are here."""

import importlib.metadata
import shutil
import subprocess
import sys
from types import SimpleNamespace

import pytest

from proxy import cli, exit_codes
from proxy.cli import main
from proxy.commands.completion import SHELLS

ASK = """
source "$1"; shift
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMP_LINE="$*" COMP_POINT=${#COMP_LINE} COMPREPLY=()
entry=$(complete -p sendworthy)
[[ $entry =~ -F\\ ([^ ]+) ]] && "${BASH_REMATCH[1]}" sendworthy "${@: -1}"
printf '%s\\n' "${COMPREPLY[@]}"
"""
"""Does what bash does when TAB is pressed behind the last word."""


@pytest.fixture
def script(capsys, tmp_path):
    """Make the script of a shell, and return its file."""

    def made(shell):
        assert main(["completion", shell]) == exit_codes.OK
        file = tmp_path / f"sendworthy.{shell}"
        file.write_text(capsys.readouterr().out)
        return file

    return made


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("sta", "status"),
        ("status --js", "--json"),
        ("mode ", "pass shadow enforce"),
        ("run --planner.it", "--planner.iterations"),
        ("run --mode sh", "shadow"),
        ("run --log.level ", "debug info warning error"),
        ("run --mesh.scouting ", "true false"),
        ("schema st", "status"),
        ("check spe", "specs.toml"),
        ("run --config spe", "specs.toml"),
    ],
)
def test_bash_completes(script, tmp_path, words, completed):
    """Commands, flags, what they can be, and files."""
    (tmp_path / "specs.toml").touch()
    file = script("bash")
    command = ["bash", "--norc", "-c", ASK, "ask", file, "sendworthy", *words.split(" ")]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert (found.stdout.split(), found.stderr) == (completed.split(), "")


@pytest.mark.parametrize("shell", SHELLS)
def test_every_command_is_in_it_and_the_shell_reads_it(script, shell):
    """Those of other packages, too."""
    file = script(shell)
    for command in cli.commands():
        assert command in file.read_text()
    if shutil.which(shell):
        read = subprocess.run([shell, "-n", file], capture_output=True, text=True, check=True)
        assert read.stderr == ""


def test_a_command_from_elsewhere_is_completed(script, monkeypatch):
    """With its flags; one that cannot be loaded is left out."""

    def command(subparsers):
        subparsers.add_parser("dance", help="dance").add_argument("--turns", help="how often")

    def broken():
        raise ImportError("No module named 'scipy'")

    others = [SimpleNamespace(name="dance", load=lambda: command), SimpleNamespace(name="juggle", load=broken)]
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: others if group == cli.GROUP else [])
    text = script("bash").read_text()
    assert "dance" in text
    assert "--turns" in text
    assert "juggle" not in text


def test_without_its_extra_it_says_what_to_install(monkeypatch, capsys):
    """Everything else works without."""
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == exit_codes.FAILED
    assert capsys.readouterr().err == (
        'sendworthy completion needs the extra "completion": pip install "sendworthy[completion]"\n'
    )


def test_an_unknown_shell_is_refused(capsys):
    """And those that are known are named."""
    with pytest.raises(SystemExit) as left:
        main(["completion", "csh"])
    assert left.value.code == exit_codes.USAGE
    assert "(choose from" in capsys.readouterr().err
