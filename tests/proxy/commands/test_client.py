"""Asking daemons, also those that answer strangely."""

import pytest

from proxy.commands.client import NoAnswerError, connected


def test_a_refusal_is_told_in_the_daemons_words(stand_in):
    """What the daemon refuses reaches the operator."""

    def refuse(query):
        query.reply_err("a mode is one of pass, shadow, enforce")
        query.drop()

    where = stand_in({"@sendworthy/r1/mode": refuse})
    with connected(where) as client, pytest.raises(NoAnswerError) as refused:
        client.switch("r1", "fast")
    assert str(refused.value) == "the daemon refuses: a mode is one of pass, shadow, enforce"


def test_a_daemon_that_hangs_is_given_up(stand_in):
    """After two seconds there is an error, not a hanging command."""
    held = []
    where = stand_in({"@sendworthy/*/status": held.append})
    with connected(where) as client, pytest.raises(NoAnswerError) as refused:
        client.status(None)
    assert len(held) == 1
    held.clear()
    assert str(refused.value) == f"no daemon answers at {where} within 2 s"


def test_what_is_no_status_is_no_answer(stand_in):
    """A stranger on our key does not crash the command."""

    def answer(query):
        query.reply("@sendworthy/r1/status", "hello")
        query.drop()

    where = stand_in({"@sendworthy/*/status": answer})
    with connected(where) as client, pytest.raises(NoAnswerError) as refused:
        client.status(None)
    assert str(refused.value) == f"what answers at {where} is no daemon of this version"
