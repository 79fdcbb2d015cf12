"""`sendworthy config`."""

import json
import tomllib

import pytest

from proxy import exit_codes
from proxy.cli import main


@pytest.fixture
def file(tmp_path):
    """A configuration with a file beside it."""
    (tmp_path / "conf.d").mkdir()
    (tmp_path / "conf.d" / "20-radio.toml").write_text('[mesh]\ninterface = "wlan0"\n')
    file = tmp_path / "sendworthy.toml"
    file.write_text('robot = "r1"\n[mesh]\ninterface = "eth0"\nzenoh.transport.auth.usrpwd.password = "hush"\n')
    return file


def test_it_prints_the_merged_configuration_with_origins(file, capsys, monkeypatch):
    """As TOML that can be used, but for what is secret."""
    monkeypatch.setenv("SENDWORTHY_MESH__ALLOWANCE", "0.1")
    command = ["config", "--config", str(file), "--mode", "shadow", "--mesh.zenoh.transport.link.tx.lease", "5000"]
    assert main(command) == exit_codes.OK
    out = capsys.readouterr().out
    told = [line for line in reversed(out.splitlines()) if "  # " in line]  # the first of a name counts: mode
    lines = {line.partition(" = ")[0]: line.split("  # ")[-1] for line in told}
    folder = file.parent
    assert lines["robot"] == f"{file}:1"
    assert lines["mode"] == "--mode"
    assert lines["allowance"] == "SENDWORTHY_MESH__ALLOWANCE"
    assert lines["interface"] == f"{folder}/conf.d/20-radio.toml:2"
    assert lines["zenoh.transport.link.tx.lease"] == "--mesh.zenoh.transport.link.tx.lease"
    assert lines["zenoh.transport.auth.usrpwd.password"] == f"{file}:4"
    assert lines["iterations"] == "default"
    assert "hush" not in out
    mesh = tomllib.loads(out)["mesh"]
    assert (mesh["interface"], mesh["allowance"]) == ("wlan0", 0.1)


def test_programs_get_an_object_for_each_key(file, capsys):
    """With the file and the line in fields of their own."""
    assert main(["config", "--json", "--config", str(file)]) == exit_codes.OK
    out = capsys.readouterr().out
    found = {each["key"]: each for each in json.loads(out)}
    place = {"kind": "file", "name": f"{file.parent}/conf.d/20-radio.toml", "line": 2}
    assert found["mesh.interface"] == {"key": "mesh.interface", "value": "wlan0", "origin": place}
    assert found["robot"]["value"] == "r1"
    assert "hush" not in out


def test_every_mistake_of_every_layer_is_named_with_its_place(file, capsys, monkeypatch):
    """The exit code is that of a daemon that cannot start."""
    (file.parent / "conf.d" / "30.toml").write_text("\nmod = 1\n")
    monkeypatch.setenv("SENDWORTHY_MESH__SCOUTING", "maybe")
    assert main(["config", "--config", str(file), "--mode", "fast"]) == exit_codes.CONFIG
    shown = capsys.readouterr()
    assert shown.out == ""
    assert [line.split(": ")[0] for line in shown.err.splitlines()] == [
        f"{file.parent}/conf.d/30.toml:2",
        "--mode",
        "SENDWORTHY_MESH__SCOUTING",
    ]


def test_what_is_outdated_is_told_beside_it(file, capsys):
    """Not within, for that is read by programs."""
    file.write_text('[planner]\ncoordination = "shares"\n')
    assert main(["config", "--config", str(file)]) == exit_codes.OK
    shown = capsys.readouterr()
    assert 'coordination = "split"' in shown.out
    assert shown.err.startswith(f'{file}:2: planner.coordination: "shares" is called "split" now')


def test_a_flag_that_is_none_is_refused(capsys):
    """As `run` refuses it."""
    with pytest.raises(SystemExit) as left:
        main(["config", "--planner.iteration", "5"])
    assert left.value.code == exit_codes.USAGE
    assert "unknown argument --planner.iteration" in capsys.readouterr().err
