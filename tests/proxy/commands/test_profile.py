"""`sendworthy profile` against a running daemon."""

import json
import os
import signal

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.profiling.request import END
from tests.proxy.profiling.profiles import picture_of, profile


@pytest.fixture(scope="module")
def taken(daemon, tmp_path_factory):
    """A profile of the daemon as JSON, its picture, and what the daemon said of its last profile before and after."""
    picture = tmp_path_factory.mktemp("flame") / "flame.svg"
    before = daemon.status()
    with pytest.MonkeyPatch.context() as patched:
        said = []
        patched.setattr("builtins.print", lambda text, **_: said.append(text))
        command = ["profile", "--seconds", "1", "--json", "--flame", str(picture), "--connect", daemon.endpoint]
        assert main(command) == exit_codes.OK
    return json.loads(said[0]), picture, before, daemon.status()


def test_stages_and_stacks_are_told(taken):
    """What all of it took is what the stages took."""
    profile, *_ = taken
    assert profile["robot"] == "r1"
    assert profile["seconds"] >= 1.0
    assert 0.0 < sum(profile["stages"].values()) < 10.0 * profile["seconds"]
    assert sum(each["seconds"] for each in profile["stacks"]) == pytest.approx(
        sum(profile["stages"].values()), abs=1e-3
    )
    assert profile["samples"] == {"decided": 0, "passed": 0, "delivered": 0}
    named = {each["frames"][0] for each in profile["stacks"]}
    assert {"loop", "egress", "zenoh rx"} <= named


def test_the_flame_graph_is_a_picture(taken):
    """That any browser shows."""
    _, picture, *_ = taken
    assert picture_of(picture.read_text()).tag == "{http://www.w3.org/2000/svg}svg"


def test_the_status_has_the_last_profile(taken):
    """Nothing before there was one."""
    profile, _, before, after = taken
    assert "profile" not in before["daemon"]
    assert after["daemon"]["profile"] == {name: value for name, value in profile.items() if name != "stacks"}


def test_the_table_is_for_people(daemon, capsys):
    """It has every stage."""
    assert main(["profile", "--seconds", "0.2", "--robot", "r1", "--connect", daemon.endpoint]) == exit_codes.OK
    out = capsys.readouterr().out
    assert out.startswith("robot r1   0.")
    assert "\ntabulation " in out


def test_too_much_is_refused(capsys):
    """Before anybody is asked."""
    assert main(["profile", "--seconds", "3600"]) == exit_codes.USAGE
    assert capsys.readouterr().err == "sendworthy profile: seconds must be from 0.1 to 60, not 3600\n"


def test_a_file_that_cannot_be_written_is_named(daemon, capsys, tmp_path):
    """Before anybody is asked; where it is found out afterwards the table is printed all the same."""
    where = str(tmp_path / "missing" / "flame.svg")
    command = ["profile", "--seconds", "0.1", "--connect", daemon.endpoint, "--flame"]
    assert main([*command, where]) == exit_codes.FAILED
    caught = capsys.readouterr()
    assert not caught.out
    assert caught.err == f"sendworthy profile: cannot write {where}: No such file or directory\n"
    assert main([*command, "/dev/full"]) == exit_codes.FAILED
    caught = capsys.readouterr()
    assert "STAGE" in caught.out
    assert caught.err == "sendworthy profile: cannot write /dev/full: No space left on device\n"


def test_a_refusal_is_told(stand_in, capsys):
    """As the daemon words it."""

    def refuse(query):
        query.reply_err("a profile is being taken; it ends in 3.0 s")
        query.drop()

    where = stand_in({"@sendworthy/r1/profile": refuse})
    assert main(["profile", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == (
        "sendworthy profile: the daemon refuses: a profile is being taken; it ends in 3.0 s\n"
    )


def test_ctrl_c_shows_what_was_seen_until_then(stand_in, capsys):
    """The daemon is told to end."""
    waiting = []

    def answer(query):
        if bytes(query.payload) == END:
            query.reply("@sendworthy/r1/profile", json.dumps(profile().write()))
            query.drop()
        else:
            waiting.append(query)
            os.kill(os.getpid(), signal.SIGINT)

    where = stand_in({"@sendworthy/r1/profile": answer})
    assert main(["profile", "--robot", "r1", "--connect", where]) == exit_codes.OK
    assert "\nall " in capsys.readouterr().out
    assert len(waiting) == 1


@pytest.mark.parametrize("told", [{}, profile().write() | {"looks": -1}, profile().write() | {"seconds": 10**400}])
def test_what_is_no_profile_is_no_daemon(stand_in, capsys, told):
    """Of this version."""

    def answer(query):
        query.reply("@sendworthy/r1/profile", json.dumps(told))
        query.drop()

    where = stand_in({"@sendworthy/r1/profile": answer})
    assert main(["profile", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert "is no daemon of this version" in capsys.readouterr().err
