"""`sendworthy page` on the command line."""

import socket

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.commands.page import _host
from tests.ports import free_port


def test_a_port_that_is_taken_is_said(capsys):
    """In one line."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["page", "--listen", f"127.0.0.1:{port}"]) == exit_codes.FAILED
    assert capsys.readouterr().err.startswith(f"sendworthy page: nothing can listen on 127.0.0.1:{port}: ")
    assert main(["page", "--listen", "[2001:db8::1]:7448"]) == exit_codes.FAILED


def test_without_what_it_needs_the_command_says_how_to_get_it(monkeypatch, capsys):
    """It comes with an extra."""
    monkeypatch.setattr("proxy.commands.page.there", lambda package: package != "uvicorn")
    assert main(["page"]) == exit_codes.FAILED
    assert 'sendworthy page needs the extra "page": pip install "sendworthy[page]"' in capsys.readouterr().err


@pytest.mark.parametrize(
    ("flag", "problem"),
    [
        ("--listen=7448", "must be a host and a port"),
        ("--listen=", "must not be empty"),
        ("--key=/robot", "must be a key expression"),
        ("--interval=0", "must be 0.1 to 3600 seconds"),
        ("--connect=nowhere", "must be an endpoint"),
    ],
)
def test_flags_that_make_no_sense_are_refused(flag, problem, capsys):
    """Before anything is opened."""
    with pytest.raises(SystemExit) as left:
        main(["page", flag])
    assert left.value.code == exit_codes.USAGE
    assert problem in capsys.readouterr().err


def test_a_configuration_that_is_wrong_is_said(tmp_path, capsys):
    """Before the page is served; so are specs, and that there is no place for the page."""
    config, listen = tmp_path / "ground.toml", f"--listen=127.0.0.1:{free_port()}"
    config.write_text("robot = 3\n")
    assert main(["page", "--config", str(config), listen]) == exit_codes.CONFIG
    assert capsys.readouterr().err.startswith(f"{config}:1: robot: ")
    config.write_text(f'[app]\nlisten = []\nconnect = ["tcp/127.0.0.1:1"]\n[specs]\npath = "{tmp_path}/specs.d"\n')
    assert main(["page", "--config", str(config), listen]) == exit_codes.FAILED
    assert "app.listen: the page needs a place" in capsys.readouterr().err
    (tmp_path / "specs.d").mkdir()
    (tmp_path / "specs.d" / "a.toml").write_text("oops\n")
    config.write_text(f'[specs]\npath = "{tmp_path}/specs.d"\n')
    assert main(["page", "--config", str(config), listen]) == exit_codes.FAILED
    assert "a.toml:1" in capsys.readouterr().err


def test_the_address_is_one_that_can_be_opened():
    """Where all addresses are listened on it is this machine's own."""
    assert [_host(each) for each in ("127.0.0.1:1", "0.0.0.0:1", "[::]:1", "[fe80::1]:1")] == [
        *("127.0.0.1", "127.0.0.1", "[::1]", "[fe80::1]"),
    ]
