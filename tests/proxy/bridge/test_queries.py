"""Queries between apps of different robots."""

from functools import partial

import zenoh

from proxy.bridge import queries as queries_module
from proxy.bridge.lane import Lane
from proxy.bridge.queries import Queries
from proxy.bridge.rules import Way
from tests.proxy.bridge.robots import fence_apps
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session
from tests.waiting import wait_until

NONE = zenoh.ConsolidationMode.NONE
ALL = zenoh.QueryTarget.ALL


def serve(app, key, answer):
    """Declare a queryable that runs `answer` on each query."""

    def receive(query):
        with query:
            answer(query)

    return app.declare_queryable(key, zenoh.handlers.Callback(receive))


def wait_answering(robot, count):
    """Wait until `count` remote queryables are mirrored for the robot's apps, and their router knows."""
    wait_until(
        lambda: len(robot.bridge.describe()["queryables"]["outward"]) == count,
        what=f"{count} mirrored queryables",
    )
    fence_apps(robot)


def test_a_query_and_all_its_replies_cross(pair):
    """Selector, payload, encoding and attachment arrive; replies on several keys, deletes and errors come back."""
    asked = []

    def answer(query):
        asked.append(
            (
                str(query.selector),
                bytes(query.payload),
                str(query.encoding),
                bytes(query.attachment),
            )
        )
        query.reply("service/a", b"one", encoding="text/plain;s", attachment=b"more")
        query.reply("service/b", b"two")
        query.reply_del("service/c")
        query.reply_err(b"three", encoding="text/json")

    serve(pair[1].node(), "service/*", answer)
    wait_answering(pair[0], 1)
    replies = list(
        pair[0]
        .node()
        .get(
            "service/*?x=1;y=two",
            consolidation=NONE,
            payload=b"question",
            encoding="application/json;q",
            attachment=b"extra",
            timeout=5.0,
        )
    )
    assert asked == [("service/*?x=1;y=two", b"question", "application/json;q", b"extra")]
    ok = {str(reply.ok.key_expr): reply.ok for reply in replies if reply.ok}
    assert set(ok) == {"service/a", "service/b", "service/c"}
    assert (ok["service/a"].payload.to_string(), str(ok["service/a"].encoding)) == ("one", "text/plain;s")
    assert bytes(ok["service/a"].attachment) == b"more"
    assert ok["service/c"].kind == zenoh.SampleKind.DELETE
    (error,) = [reply.err for reply in replies if reply.err]
    assert (error.payload.to_string(), str(error.encoding)) == ("three", "text/json")


def test_overlapping_queryables_answer_once_each(team):
    """Queryables of two robots that overlap each answer a query once, from whichever robot it comes."""
    for n, key in ((1, "service/*"), (2, "service/a")):
        serve(team[n].node(), key, lambda query, n=n: query.reply("service/a", f"r{n}"))
    wait_answering(team[0], 2)
    wait_answering(team[1], 1)
    ask = partial(answers, selector="service/a", consolidation=NONE, target=ALL)
    assert sorted(ask(team[0].node())) == ["r1", "r2"]
    assert sorted(ask(team[1].node())) == ["r1", "r2"]


def test_local_and_remote_queryables_of_one_key_both_answer(pair):
    """An app that asks everybody gets its own robot's answer and the other's, each once."""
    for n, robot in enumerate(pair):
        serve(robot.node(), "service/both", lambda query, n=n: query.reply("service/both", str(n)))
    wait_answering(pair[0], 1)
    assert sorted(answers(pair[0].node(), "service/both", consolidation=NONE, target=ALL)) == ["0", "1"]


def test_nobody_answers_for_a_queryable_that_is_gone(pair):
    """When the app takes its queryable back, so does its robot on the mesh, and a query ends at once."""
    served = serve(pair[1].node(), "service/gone", lambda query: query.reply("service/gone", "x"))
    wait_answering(pair[0], 1)
    served.undeclare()
    wait_answering(pair[0], 0)
    assert list(answers(pair[0].node(), "service/gone")) == []


def test_replies_on_other_keys_cross_when_they_are_accepted(pair):
    """A query that accepts any key says so on the other side too."""
    serve(pair[1].node(), "service/any", lambda query: query.reply("elsewhere/a", "x"))
    wait_answering(pair[0], 1)
    accepted = answers(pair[0].node(), "service/any", accept_replies=zenoh.ReplyKeyExpr.ANY)
    assert list(accepted) == ["x"]


def test_too_many_queries_are_answered_with_an_error(stack, monkeypatch):
    """Beyond its bound a query is refused with a reason instead of waiting for nobody."""
    monkeypatch.setattr(queries_module, "MOST_PENDING", 0)
    near_endpoint = free_endpoint()
    near = closing(stack, plain_session("router", listen=(near_endpoint,)))
    far = closing(stack, plain_session("peer"))
    lane = Lane("test")
    stack.callback(lane.close, 1.0)
    queries = Queries(near, far, lane, Way(("**",), ()))
    queries.update({"service/a": False})
    stack.callback(queries.close)
    asker = closing(stack, plain_session("client", connect=(near_endpoint,)))
    assert list(answers(asker, "service/a")) == ["error: too many queries under way"]


def test_a_closed_far_side_is_an_error_and_ends_the_query(stack):
    """A session that cannot ask any more answers with Zenoh's reason."""
    near_endpoint = free_endpoint()
    near = closing(stack, plain_session("router", listen=(near_endpoint,)))
    far = plain_session("peer")
    lane = Lane("test")
    stack.callback(lane.close, 1.0)
    queries = Queries(near, far, lane, Way(("**",), ()))
    queries.update({"service/a": False})
    stack.callback(queries.close)
    far.close()
    asker = closing(stack, plain_session("client", connect=(near_endpoint,)))
    (answer,) = answers(asker, "service/a")
    assert answer.startswith("error: ")
