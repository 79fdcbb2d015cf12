"""`sendworthy push` and `sendworthy mode --fleet`, with two daemons."""

import re
import signal

import pytest

from proxy import exit_codes
from proxy.cli import main
from tests.daemons import ROOT, specs_file
from tests.ports import free_port
from tests.proxy.nodes import Heard, plain_session
from tests.waiting import wait_until


@pytest.fixture
def team(start, tmp_path):
    """Two linked daemons, each with specs of its own in a folder; r2 obeys all orders, r1 takes no specs."""
    mesh = f"tcp/127.0.0.1:{free_port()}"
    daemons = []
    for name, options in (
        ("r1", ("--mesh.listen", f'["{mesh}"]', "--fleet.mode", "true")),
        ("r2", ("--mesh.connect", f'["{mesh}"]', "--fleet.mode", "true", "--fleet.specs", "true")),
    ):
        folder = tmp_path / name / "specs.d"
        folder.mkdir(parents=True)
        specs_file(folder)
        daemon = start("--robot", name, "--specs.path", str(folder), *options)
        daemon.wait_for("sendworthy ")
        daemons.append(daemon)
    wait_until(lambda: all(daemon.status()["peers"] for daemon in daemons), what="the robots to meet")
    return daemons


def test_specs_and_modes_reach_the_team(team, tmp_path, capsys):
    """Each robot answers for itself; who may not be ordered says so and keeps what it has."""
    new = specs_file(tmp_path)
    new.write_text(new.read_text().replace("2 Mbit/s", "1 Mbit/s"))
    before = team[0].status()["specs"]
    assert main(["push", str(new), "--connect", team[0].endpoint]) == exit_codes.FAILED
    out, err = capsys.readouterr()
    assert err == "r1: fleet.specs is false in its configuration\n"
    assert out == f"r2: specs {team[1].status()['specs']} in force\n"
    assert team[0].status()["specs"] == before != team[1].status()["specs"]
    assert (tmp_path / "r2" / "specs.d" / new.name).read_text() == new.read_text()
    assert main(["mode", "shadow", "--fleet", "--connect", team[0].endpoint]) == exit_codes.OK
    assert capsys.readouterr().out == "r1: mode shadow\nr2: mode shadow\n"
    assert [daemon.status()["mode"] for daemon in team] == ["shadow", "shadow"]
    team[1].end(signal.SIGTERM)
    wait_until(lambda: not team[0].status()["peers"], what="the other one to be gone")
    assert main(["mode", "pass", "--fleet", "--connect", team[0].endpoint]) == exit_codes.OK
    assert capsys.readouterr().out == "r1: mode pass\n"


def test_specs_with_mistakes_are_not_even_sent(tmp_path, capsys):
    """They are checked here, as `sendworthy check` does it; nobody is asked."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace('"video"', '"vidoe"'))
    assert main(["push", str(specs), "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith(f'{specs}:10: information_type "camera": utility.kind: ')


def test_robots_may_check_what_cannot_be_checked_here(start, tmp_path, capsys):
    """What needs a module that only they have goes unchecked, and their mistakes come back."""
    specs = specs_file(tmp_path)
    specs.write_text(specs.read_text().replace('kind = "video"', 'kind = "python", function = "not_here:worth"'))
    folder = tmp_path / "specs.d"
    daemon = start("--robot", "r1", "--fleet.specs", "true", "--specs.path", str(specs_file(make(folder)).parent))
    daemon.wait_for("sendworthy ")
    assert main(["push", str(specs), "--unchecked", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith('r1: camera.toml:10: information_type "camera": utility.function: ')


def make(folder):
    folder.mkdir()
    return folder


def test_without_a_daemon_nothing_is_pushed(tmp_path, capsys):
    """The message is that of all commands."""
    assert main(["push", str(specs_file(tmp_path)), "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith("sendworthy push: no daemon answers at tcp/127.0.0.1:1")
    assert main(["mode", "pass", "--fleet", "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith("sendworthy mode: no daemon answers at tcp/127.0.0.1:1")


@pytest.fixture
def guarded(start, tmp_path):
    """Three robots with passwords, as in the manual; r1 obeys, and it and the operator have its access control."""
    manual = (ROOT / "deploy" / "README.md").read_text()
    (acl,) = [block for block in re.findall(r"```toml\n(.*?)```", manual, re.DOTALL) if "access_control" in block]
    dictionary, folder, mesh = tmp_path / "robots", tmp_path / "specs.d", f"tcp/127.0.0.1:{free_port()}"
    dictionary.write_text("".join(f"{name}:a secret of {name}\n" for name in ("r1", "ground", "visitor")))
    acl = acl.replace("/etc/sendworthy/robots", str(dictionary))
    orders = ("--fleet.specs", "true", "--fleet.mode", "true")
    obeys = ("--mesh.listen", f'["{mesh}"]', *orders, "--specs.path", str(folder))
    specs_file(make(folder))
    daemons = []
    for name, options in (
        ("r1", obeys),
        *((name, ("--mesh.connect", f'["{mesh}"]')) for name in ("ground", "visitor")),
    ):
        file = tmp_path / f"{name}.toml"
        said = acl[: acl.index("[mesh.zenoh.access")] if name == "visitor" else acl
        file.write_text(said.replace("r1", name))
        daemons.append(start("--config", str(file), "--robot", name, *options))
    for daemon in daemons:
        daemon.wait_for("sendworthy ")
    wait_until(lambda: [len(daemon.status()["peers"]) for daemon in daemons] == [2, 1, 1], what="the robots to meet")
    return daemons


def test_access_control_lets_one_operator_order_and_no_other(guarded, tmp_path, capsys):
    """What is in the manual, word for word: the robot obeys the one and does not hear the other."""
    new = specs_file(tmp_path)
    new.write_text(new.read_text().replace("2 Mbit/s", "1 Mbit/s"))
    r1, ground, visitor = guarded
    before = r1.status()["specs"]
    main(["push", str(new), "--connect", visitor.endpoint])
    assert "r1: no answer: it is out of reach, or fleet.specs is false" in capsys.readouterr().err
    assert r1.status()["specs"] == before
    main(["push", str(new), "--connect", ground.endpoint])
    assert f"r1: specs {r1.status()['specs']} in force\n" in capsys.readouterr().out
    assert r1.status()["specs"] != before
    main(["mode", "shadow", "--fleet", "--connect", visitor.endpoint])
    assert r1.status()["mode"] == "enforce"
    main(["mode", "shadow", "--fleet", "--connect", ground.endpoint])
    assert "r1: mode shadow\n" in capsys.readouterr().out
    assert not [line for robot in guarded for line in robot.lines if "ERROR" in line]
    with (
        plain_session("client", connect=[visitor.endpoint]) as app,
        plain_session("client", connect=[r1.endpoint]) as other,
    ):
        heard = Heard(other, "data")
        wait_until(lambda: app.put("data", "x") or heard.payloads, what="data, which everybody may send")
