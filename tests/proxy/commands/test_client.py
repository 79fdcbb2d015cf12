"""Asking daemons, also those that answer strangely."""

import threading
from contextlib import closing
from dataclasses import replace

import pytest

from proxy.bridge.tuning import TUNING
from proxy.commands.client import NoAnswerError, connected
from proxy.why import Question
from tests.proxy.nodes import plain_session, wait_matching
from tests.waiting import wait_until


def test_a_refusal_is_told_in_the_daemons_words(stand_in):
    """What the daemon refuses reaches the operator, whatever it is."""
    words = [b"a mode is one of pass, shadow, enforce", b"\xff"]

    def refuse(query):
        query.reply_err(words.pop(0))
        query.drop()

    with connected(stand_in({"@sendworthy/r1/mode": refuse})) as client:
        for told in ("a mode is one of pass, shadow, enforce", "\ufffd"):
            with pytest.raises(NoAnswerError) as refused:
                client.switch("r1", "fast")
            assert str(refused.value) == f"the daemon refuses: {told}"


def test_a_daemon_that_hangs_is_given_up(stand_in, monkeypatch):
    """After two seconds, and as many more as what is asked may take, there is an error, not a hanging command."""
    held = []
    where = stand_in({"@sendworthy/*/status": held.append, "@sendworthy/r1/to-fleet/mode": held.append})
    with connected(where) as client:
        monkeypatch.setattr("proxy.commands.client.TIMEOUT", 0.5)
        monkeypatch.setattr("proxy.commands.client.TUNING", replace(TUNING, order_wait=1.0))
        with pytest.raises(NoAnswerError) as refused:
            client.status(None)
        with pytest.raises(NoAnswerError) as ordered:
            client.order("r1", "mode", b"pass")
        wait_until(lambda: len(held) == 2, what="both questions")
        held.clear()
    assert str(refused.value) == f"no daemon answers at {where} within 0.5 s"
    assert str(ordered.value) == f'no daemon of robot "r1" answers at {where} within 1.5 s'


def test_a_daemon_that_does_not_know_what_it_is_asked_is_of_another_version(stand_in):
    """It is there, as its status says; of one that is not there nothing is known."""

    def answer(query):
        query.reply("@sendworthy/r1/status", '{"robot": "r1"}')
        query.drop()

    with connected(where := stand_in({"@sendworthy/r1/status": answer})) as client:
        with pytest.raises(NoAnswerError) as refused:
            client.why("r1", Question("camera"))
        assert str(refused.value) == f'the daemon of robot "r1" at {where} is of a version that cannot do that'
        with pytest.raises(NoAnswerError) as refused:
            client.why("r2", Question("camera"))
        assert str(refused.value) == f'no daemon of robot "r2" answers at {where}'


STRANGE = (
    "hello",
    '{"robot":"r1","streams":{"rows":[[1]]}}',
    '{"robot":"r1","streams":{"columns":["key","type"],"rows":[["a"]]}}',
    "[" * 100_000,
    b"\xff",
    "[]",
    "5",
    '{"uptime":"x"}',
    '{"robot":"r1","uptime":"x"}',
    '{"robot":"r1","streams":[5]}',
    '{"robot":"r1","peers":{"a":1}}',
    '{"robot":"r1","streams":{"columns":["key","generated"],"rows":[["a","many"]]}}',
)


@pytest.mark.parametrize("told", STRANGE)
def test_what_is_no_status_is_no_answer(stand_in, told):
    """A stranger on our key does not crash the command."""

    def answer(query):
        query.reply("@sendworthy/r1/status", told)
        query.drop()

    where = stand_in({"@sendworthy/*/status": answer})
    with connected(where) as client, pytest.raises(NoAnswerError) as refused:
        client.status(None, live=True)
    assert str(refused.value) == f"what answers at {where} is no daemon of this version"


def test_streams_are_tables_also_where_they_come_as_rows(stand_in):
    """As `top` hears of them."""

    def answer(query):
        query.reply("@sendworthy/r1/status", '{"robot":"r1","streams":{"columns":["key","size"],"rows":[["a",3]]}}')
        query.drop()

    with connected(stand_in({"@sendworthy/*/status": answer})) as client:
        assert client.status(None, live=True) == [{"robot": "r1", "streams": [{"key": "a", "size": 3}]}]


def test_samples_are_what_is_put_until_the_time_is_over(stand_in):
    """Deletes are none; nobody waits for ever, though one may ask for that."""
    where, key = stand_in({}), "robot/r1/pose"

    def publish():
        with plain_session("client", connect=[where]) as app:
            wait_matching(app, key)
            app.delete(key)
            app.put(key, "here")

    thread = threading.Thread(target=publish)
    thread.start()
    with connected(where) as client:
        with closing(client.samples(key, 1e300)) as samples:
            assert next(samples).payload.to_string() == "here"
        thread.join()
        with pytest.raises(NoAnswerError, match=f"no sample of {key} came within"):
            next(client.samples(key, 0.01))
