"""Daemons that take proofs of their applications, and commands that have them."""

import json

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.commands.credentials import VARIABLE, of_environment, of_options
from tests.ports import free_port

USER = {"transport": {"auth": {"usrpwd": {"user": "operator", "password": "of the operator"}}}}


@pytest.fixture
def closed(start, tmp_path):
    """A configuration whose daemon runs and takes nobody without a password."""
    users, endpoint = tmp_path / "users", f"tcp/127.0.0.1:{free_port()}"
    users.write_text("r1:of the robot\noperator:of the operator\n")
    file = tmp_path / "sendworthy.toml"
    file.write_text(
        f'robot = "r1"\n[app]\nlisten = ["{endpoint}"]\n[mesh]\nlisten = []\nscouting = false\n'
        f'[app.zenoh.transport.auth.usrpwd]\nuser = "r1"\npassword = "of the robot"\ndictionary_file = "{users}"\n'
    )
    start("--config", str(file), endpoint=endpoint).wait_for("sendworthy ")
    return file, endpoint


def test_commands_prove_who_they_are_as_applications_do(closed, tmp_path, monkeypatch, capsys):
    """By what the file has that Zenoh's own variable names; what else it has does not concern them."""
    _, endpoint = closed
    status = ["status", "--connect", endpoint]
    assert main(status) == exit_codes.FAILED
    file = tmp_path / "application.json5"
    monkeypatch.setenv(VARIABLE, str(file))
    assert main(status) == exit_codes.FAILED
    refused = capsys.readouterr().err.splitlines()
    assert refused[0] == f"sendworthy status: no daemon answers at {endpoint}; is `sendworthy run` running?"
    assert refused[1] == f"{refused[0]} ({VARIABLE}: {file}: No such file or directory (os error 2))"
    elsewhere = {"endpoints": [f"tcp/127.0.0.1:{free_port()}"], "timeout_ms": -1}
    file.write_text(json.dumps(USER | {"mode": "peer", "namespace": "mine", "connect": elsewhere}))
    assert main(status) == exit_codes.OK
    assert capsys.readouterr().out.startswith("robot r1 ")


def test_the_doctor_has_them_from_the_configuration(closed, capsys):
    """Else it took the daemon for another process, which is to be ended."""
    file, endpoint = closed
    main(["doctor", "--config", str(file)])
    found = capsys.readouterr().out
    assert f"{endpoint}: the daemon of this robot listens there" in found
    assert "robot r1 in mode enforce warns of nothing" in found


def test_credentials_are_those_of_links_alone(monkeypatch):
    """Of TLS and of users; where there are none, nothing is set."""
    tls = {"root_ca_certificate": "ca.pem"}
    found = of_options({"mode": "peer", "transport": {"link": {"tls": tls, "tx": {"lease": 5}}} | {"auth": {}}})
    assert found == {"transport/link/tls": json.dumps(tls)}
    monkeypatch.delenv(VARIABLE, raising=False)
    assert of_environment() == ({}, "")
