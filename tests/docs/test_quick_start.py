"""The quick start works from top to bottom."""

import os
import shutil
import subprocess
import sys
from contextlib import ExitStack

import pytest

from tests.docs.pages import ROOT, blocks
from tests.docs.terminal import Terminal
from tests.ports import free_port
from tests.waiting import wait_until

PAGE = ROOT / "docs" / "quick-start.md"
HERE = """
sendworthy() {{
    case $1 in
    run) exec {program} "$@" --app.listen '["{app}"]' --mesh.listen '[]' --mesh.scouting false ;;
    check) {program} "$@" && until grep -q 'files changed: specs ' ../first.txt; do sleep 0.1; done ;;
    learn) {program} "$@" --connect {app} --seconds 3 ;;
    doctor) {program} "$@" --connect {app} || [ $? -le 2 ] ;;
    *) {program} "$@" --connect {app} ;;
    esac
}}
"""
"""Goes behind `activate`: ports of our own, a shorter while to listen, and this machine's clock may be wrong.

What is typed after `check` is typed when the daemon has taken up what was learned.
"""
INSTALLED = ("python3 -m venv venv\n", "venv/bin/pip install .\n")
ENTERED = ". ../venv/bin/activate\n"
"""What a terminal begins with; the fourth block is typed in the third one."""


def place(folder, endpoint):
    """What the page takes from the repository, with ports of our own."""
    shutil.copytree(ROOT / "deploy", folder / "deploy")
    client = folder / "deploy" / "apps" / "client.json5"
    client.write_text(client.read_text().replace("tcp/127.0.0.1:7447", endpoint))


def tried(folder, closing):
    """Do what the page says, from making the folder on, where `venv` is there; return what was printed last."""
    first, second, third, fourth = blocks(PAGE, "sh")
    assert second.startswith(ENTERED)
    assert third.startswith(ENTERED)
    for line in INSTALLED:
        assert line in first
        first = first.replace(line, "")
    robot = folder / "robot"
    daemon = Terminal("first", first, folder)
    closing.callback(daemon.close)
    wait_until(lambda: daemon.says("no specs in specs.d: everything passes"), what="the start of the daemon")
    closing.callback(Terminal("second", second, robot).close)
    shown = Terminal("third", third + fourth, robot)
    closing.callback(shown.close)
    text = shown.wait()
    wait_until(lambda: daemon.says("files changed: specs "), what="the daemon to take up what was learned")
    assert (robot / "specs.d" / "learned.toml").exists()
    return text


def test_all_of_it_works(tmp_path):
    """Every line, in three terminals; what is learned is what the daemon reads. Alone it drops nothing."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    place(tmp_path, endpoint)
    activate = tmp_path / "venv" / "bin" / "activate"
    activate.parent.mkdir(parents=True)
    own = HERE.format(program=f"{sys.executable} -m proxy.cli", app=endpoint)
    python = f'python() {{ {sys.executable} "$@"; }}'  # a link to it would know nothing of its packages
    activate.write_text(f"export PYTHONPATH={ROOT}\n{python}\n{own}")
    with ExitStack() as closing:
        text = tried(tmp_path, closing)
    assert 'information_type "battery": robot/*/battery' in text
    assert "robot r1   mode enforce   sendworthy " in text
    alone = "no other robot is on the mesh"
    assert f"`{alone}`" in PAGE.read_text()
    assert alone in text
    assert "samples  0 in = 0 forwarded + 0 dropped" in text


@pytest.mark.full
def test_it_begins_with_an_installation_that_works(tmp_path):
    """In a virtual environment of its own, built from the sources, with the dependencies that it says it has."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        target = tmp_path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, target)
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    shutil.rmtree(tmp_path / "deploy")
    place(tmp_path, endpoint)
    environ = os.environ | {"PIP_NO_COMPILE": "1"}  # most of what is installed is never imported
    subprocess.run(["bash", "-ec", "".join(INSTALLED)], cwd=tmp_path, env=environ, check=True, capture_output=True)
    with (tmp_path / "venv" / "bin" / "activate").open("a") as activate:
        activate.write(HERE.format(program=tmp_path / "venv" / "bin" / "sendworthy", app=endpoint))
    with ExitStack() as closing:
        assert "robot r1   mode enforce   sendworthy " in tried(tmp_path, closing)
