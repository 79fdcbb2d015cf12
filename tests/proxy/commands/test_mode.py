"""`sendworthy mode` against a running daemon."""

import json

import pytest

from proxy import exit_codes
from proxy.cli import main


@pytest.mark.parametrize("mode", ["pass", "shadow", "enforce"])
def test_the_mode_is_switched(daemon, capsys, mode):
    """The daemon is in the new mode when the command returns."""
    assert main(["mode", mode, "--connect", daemon.endpoint]) == exit_codes.OK
    assert capsys.readouterr().out == f"r1: {mode}\n"
    main(["status", "--json", "--connect", daemon.endpoint])
    assert json.loads(capsys.readouterr().out)["mode"] == mode


def test_a_robot_may_be_named(daemon, capsys):
    """Only that robot's daemon is asked."""
    assert main(["mode", "pass", "--robot", "r1", "--connect", daemon.endpoint]) == exit_codes.OK
    assert main(["mode", "pass", "--robot", "r2", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert 'no daemon of robot "r2" answers' in capsys.readouterr().err


def test_of_several_daemons_one_must_be_chosen(stand_in, capsys):
    """Nothing is switched by accident."""

    def answer(query):
        for robot in ("r1", "r2"):
            query.reply(f"@sendworthy/{robot}/status", json.dumps({"robot": robot}))
        query.drop()

    where = stand_in({"@sendworthy/*/status": answer})
    assert main(["mode", "pass", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == (
        f"sendworthy mode: several daemons answer at {where}: choose with --robot r1|r2\n"
    )


def test_what_other_robots_answer_moves_no_cursor(stand_in, capsys):
    """It is their words."""

    def tell(query):
        query.reply("@sendworthy/r1/to-fleet/mode", json.dumps([{"robot": "r2", "obeyed": True, "said": ["\x1b[2J"]}]))
        query.drop()

    where = stand_in({"@sendworthy/r1/to-fleet/mode": tell})
    assert main(["mode", "shadow", "--fleet", "--robot", "r1", "--connect", where]) == exit_codes.OK
    assert capsys.readouterr().out == "r2: \ufffd[2J\n"


@pytest.mark.parametrize("told", ["hello", "[]", '[{"robot": "r1"}]', "[" * 100_000])
def test_what_tells_of_no_robot_is_no_answer(stand_in, capsys, told):
    """A daemon tells of itself at least: nobody takes it for obeyed where nothing is said."""

    def tell(query):
        query.reply("@sendworthy/r1/to-fleet/mode", told)
        query.drop()

    where = stand_in({"@sendworthy/r1/to-fleet/mode": tell})
    assert main(["mode", "pass", "--fleet", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy mode: what answers at {where} is no daemon of this version\n"


def test_another_mode_is_no_answer(stand_in, capsys):
    """Whoever does not confirm the mode is no daemon, or did not switch."""
    where = stand_in({"@sendworthy/r1/mode": lambda query: query.reply("@sendworthy/r1/mode", "pass")})
    assert main(["mode", "shadow", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy mode: what answers at {where} is no daemon of this version\n"
