"""`sendworthy status` against a running daemon."""

import json

from proxy import exit_codes
from proxy.cli import main
from proxy.status.model import Status
from tests.ports import free_port


def test_the_table_shows_the_daemon(daemon, capsys):
    """A person sees who it is and what it did."""
    assert main(["status", "--connect", daemon.endpoint]) == exit_codes.OK
    out = capsys.readouterr().out
    assert out.startswith("robot r1   mode ")
    assert "samples  0 in = 0 forwarded + 0 dropped + 0 queued" in out
    assert "throughput   0.5 s" in out


def test_json_is_everything_the_daemon_tells(daemon, capsys):
    """A program gets one object."""
    assert main(["status", "--json", "--robot", "r1", "--connect", daemon.endpoint]) == exit_codes.OK
    status = json.loads(capsys.readouterr().out)
    assert status["robot"] == "r1"
    assert status["counts"]["conserved"] is True
    Status.model_validate(status)


def test_a_robot_that_does_not_answer_is_named(daemon, capsys):
    """Another robot's daemon cannot be asked here."""
    assert main(["status", "--robot", "r2", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert capsys.readouterr().err == (f'sendworthy status: no daemon of robot "r2" answers at {daemon.endpoint}\n')


def test_without_a_daemon_the_message_says_so(capsys):
    """Nobody listens: one clear line."""
    where = f"tcp/127.0.0.1:{free_port()}"
    assert main(["status", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == (
        f"sendworthy status: no daemon answers at {where}; is `sendworthy run` running?\n"
    )


def test_several_answers_are_a_list(stand_in, capsys):
    """Whoever answers is shown, by name."""

    def answer(query):
        for robot in ("r2", "r1"):
            query.reply(f"@sendworthy/{robot}/status", json.dumps({"robot": robot}))
        query.drop()

    where = stand_in({"@sendworthy/*/status": answer})
    assert main(["status", "--json", "--connect", where]) == exit_codes.OK
    assert json.loads(capsys.readouterr().out) == [{"robot": "r1"}, {"robot": "r2"}]
    assert main(["status", "--connect", where]) == exit_codes.OK
    assert "\n\nrobot r2   mode -" in capsys.readouterr().out


def test_every_word_can_be_explained(capsys):
    """Without a daemon."""
    assert main(["status", "--explain"]) == exit_codes.OK
    out = capsys.readouterr().out
    assert "  WANTED BY  how many robots want it\n" in out
    assert "dropped:superseded" in out
