"""`sendworthy doctor`, beside real daemons and without one."""

import json

import pytest

from proxy import exit_codes
from proxy.cli import main
from tests.daemons import specs_file
from tests.ports import free_port
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


@pytest.fixture
def file(tmp_path):
    """A configuration of robots that meet nobody unless they are told."""
    (tmp_path / "specs.d").mkdir()
    specs_file(tmp_path / "specs.d")
    file = tmp_path / "sendworthy.toml"
    file.write_text(f'robot = "r1"\n[app]\nlisten = ["{free_endpoint()}"]\n[mesh]\nlisten = []\nscouting = false\n')
    return file


@pytest.fixture
def doctor(file, capsys):
    """Look as a program does; return the exit code and the lines by check."""

    def look(*flags):
        code = main(["doctor", "--json", "--config", str(file), *flags])
        found = json.loads(capsys.readouterr().out)
        # Whether the clock of this machine is right is no matter here.
        return code, [(each["state"], each["check"], each["text"]) for each in found if each["check"] != "clock"]

    return look


def states(found):
    return {(state, check) for state, check, _ in found}


def test_a_running_daemon_is_asked(daemon, doctor, file):
    """It has its ports, and all is fine: a line for each thing that was looked at."""
    specs = str(specs_file(file.parent))
    code, found = doctor("--app.listen", f'["{daemon.endpoint}"]', "--specs.path", specs)
    looked = ("configuration", "port", "interface", "specs", "recordings", "daemon", "applications", "other robots")
    assert states(found) == {("fine", check) for check in looked}
    assert ("fine", "port", f"{daemon.endpoint}: the daemon of this robot listens there") in found
    assert code in {exit_codes.OK, exit_codes.FAILED}, "the clock alone"


def test_without_a_daemon_all_else_is_looked_at(doctor, file, capsys):
    """And it is said that other robots could not be."""
    _, found = doctor()
    assert {check for state, check in states(found) if state == "unknown"} == {"daemon"}
    assert {("fine", check) for check in ("configuration", "port", "interface", "specs", "recordings")} < states(found)
    code = main(["doctor", "--config", str(file)])
    lines = capsys.readouterr().out.splitlines()
    assert code == (exit_codes.FAILED if any(line.startswith("finding") for line in lines) else exit_codes.NOT_SEEN)
    assert f"fine     configuration right ({file}; sendworthy config prints it)" in lines
    assert len(lines) == len(found) + 1, "the clock"


def test_what_is_wrong_is_said_in_one_line_each(doctor, file, stack):
    """A port that is taken, an interface that is not there, specs that do not check."""
    port = free_port()
    closing(stack, plain_session("router", listen=(f"tcp/127.0.0.1:{port}",)))
    spec = file.parent / "specs.d" / "camera.toml"
    spec.write_text(spec.read_text().replace("2 Mbit/s", "2 Mbot/s"))
    code, found = doctor("--mesh.listen", f'["tcp/127.0.0.1:{port}"]', "--mesh.interface", "nope0")
    wrong = [(check, text) for state, check, text in found if state == "finding"]
    assert code == exit_codes.FAILED
    assert [check for check, _ in wrong] == ["port", "interface", "specs"]
    assert f"tcp/127.0.0.1:{port}: another process, " in wrong[0][1]
    assert wrong[1][1].startswith("there is no nope0")
    assert wrong[2][1].startswith(f"{spec}:3: ")


def test_the_port_of_the_metrics_is_looked_at_too(doctor, stack):
    """Else the daemon would say so when it starts."""
    port = free_port()
    closing(stack, plain_session("router", listen=(f"tcp/127.0.0.1:{port}",)))
    _, found = doctor("--metrics.listen", f"127.0.0.1:{port}")
    (wrong,) = [text for state, check, text in found if (state, check) == ("finding", "port")]
    assert wrong.startswith(f"tcp/127.0.0.1:{port}: another process")


def test_a_wrong_configuration_is_named_and_the_daemon_asked_all_the_same(daemon, doctor, file):
    """In whichever layer it is wrong."""
    (file.parent / "conf.d").mkdir()
    (file.parent / "conf.d" / "10.toml").write_text('\nmode = "fast"\n')
    code, found = doctor("--connect", daemon.endpoint, "--planner.horizon", "0")
    assert code == exit_codes.FAILED
    assert [text.split(": ")[0] for state, _, text in found if state == "finding"] == [
        f"{file.parent}/conf.d/10.toml:2",
        "--planner.horizon",
    ]
    assert ("fine", "daemon") in states(found)


def test_what_is_configured_and_not_installed_is_a_finding(doctor, monkeypatch):
    """The daemon would not start, or not record."""
    monkeypatch.setattr("proxy.doctor.doctor.there", lambda package: package != "mcap")
    _, found = doctor("--record.on", "true", "--metrics.listen", "127.0.0.1:9447")
    wrong = [text for state, check, text in found if (state, check) == ("finding", "configuration")]
    assert wrong == ['record needs the extra "record": pip install "sendworthy[record]"']


def test_an_application_on_the_mesh_is_found(start, stack, doctor):
    """By its link with the daemon from this host."""
    mesh = free_endpoint()
    daemon = start("--robot", "r1", "--mesh.listen", f'["{mesh}"]')
    daemon.wait_for("sendworthy ")
    app = closing(stack, plain_session("peer", connect=(mesh,)))
    wait_until(lambda: daemon.status()["daemon"]["links"], what="the link of the application")
    code, found = doctor("--app.listen", f'["{daemon.endpoint}"]', "--mesh.listen", f'["{mesh}"]')
    assert code == exit_codes.FAILED
    ((check, text),) = [(check, text) for state, check, text in found if state == "finding"]
    assert check == "applications"
    assert text.startswith(f"the Zenoh process {app.zid()} of this robot is on the mesh itself")


@pytest.mark.full
def test_a_robot_with_other_limits_is_found(start, doctor, tmp_path):
    """By what the daemon says when it has waited long enough for them to become the same."""
    mesh, specs = free_endpoint(), [tmp_path / name for name in ("a", "b")]
    for folder in specs:
        folder.mkdir()
        specs_file(folder)
    other = specs[1] / "camera.toml"
    other.write_text(other.read_text().replace("2 Mbit/s", "3 Mbit/s"))
    first = start("--robot", "r1", "--specs.path", str(specs[0]), "--mesh.listen", f'["{mesh}"]')
    second = start("--robot", "r2", "--specs.path", str(specs[1]), "--mesh.connect", f'["{mesh}"]')
    for each in (first, second):
        each.wait_for("sendworthy ")
    wait_until(lambda: first.status()["warnings"], what="the warning")
    code, found = doctor("--app.listen", f'["{first.endpoint}"]', "--mesh.listen", f'["{mesh}"]')
    assert code == exit_codes.FAILED
    ((check, text),) = [(check, text) for state, check, text in found if state == "finding"]
    assert check == "daemon"
    assert text.startswith("robot r2 has other limits (specs ")
    assert ("fine", "versions") in states(found)
