"""Queries between apps of different robots."""

import threading
from dataclasses import replace
from functools import partial

import pytest
import zenoh

from proxy.bridge import queries as queries_module
from proxy.bridge.barrier import Barrier
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declarations.source_info import enclosed, new_mark
from proxy.bridge.fence import Fence
from proxy.bridge.queries import Queries
from proxy.bridge.rules import Direction
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.sides import open_sides
from proxy.bridge.tuning import TUNING
from proxy.config import AppConfig, MeshConfig
from tests.proxy.bridge.declarations.test_wire import frame
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
    for robot in pair:
        wait_answering(robot, 1)
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


def test_attachments_that_look_strange_cross_as_they_are(pair):
    """Also what another daemon would take for its own."""
    app = pair[1].node()
    strange = enclosed(new_mark(), zenoh.SourceInfo(app.id, 7), b"more")
    serve(app, "service/a", lambda query: query.reply("service/a", "x", attachment=strange))
    wait_answering(pair[0], 1)
    (reply,) = pair[0].node().get("service/a", timeout=5.0)
    assert bytes(reply.ok.attachment) == strange
    assert reply.ok.source_info is None


def test_parameters_keep_their_order(pair):
    """The one that says that any key is accepted, too."""
    asked = []
    serve(pair[1].node(), "service/a", lambda query: asked.append((str(query.parameters), query.accepts_replies())))
    wait_answering(pair[0], 1)
    list(pair[0].node().get("service/a?a=1;_anyke;b", timeout=5.0))
    assert asked == [("a=1;_anyke;b", zenoh.ReplyKeyExpr.ANY)]


BEST, ALL_COMPLETE = zenoh.QueryTarget.BEST_MATCHING, zenoh.QueryTarget.ALL_COMPLETE


def reply_with(payload, query):
    with query:
        query.reply(payload.split()[1].replace("**", "a").replace("*", "a"), payload)


def asked_everywhere(nodes, asker, served, asked):
    """What an app of the first robot is answered to each target when `served` is declared on (robot, key, complete)."""
    for n, key, complete in served:
        answer = zenoh.handlers.Callback(partial(reply_with, f"{n} {key}"))
        nodes[n].declare_queryable(key, answer, complete=complete)
    everybody = sorted(f"{n} {key}" for n, key, _ in served)
    ask = partial(answers, asker, asked, consolidation=NONE)
    wait_until(lambda: sorted(ask(target=ALL)) == everybody, timeout=40.0, what=f"answers of {everybody}")
    return to_each_target(asker, asked)


def to_each_target(asker, asked):
    """What is answered to the best match, to all, and to all that are complete."""
    return [sorted(answers(asker, asked, consolidation=NONE, target=target)) for target in (BEST, ALL, ALL_COMPLETE)]


@pytest.mark.parametrize(
    ("asked", "served"),
    [
        pytest.param("s/a", [(1, "s/a", True)], id="one complete"),
        pytest.param("s/a", [(1, "s/a", False)], id="one incomplete"),
        pytest.param("s/a", [(1, "s/a", True), (2, "s/a", False)], id="a complete and an incomplete one"),
        pytest.param("s/a", [(1, "s/a", True), (2, "s/*", False), (1, "s/**", False)], id="one complete of several"),
        pytest.param("s/a", [(1, "s/*", False), (2, "s/a", True)], id="a narrow complete one"),
        pytest.param("s/a", [(1, "s/a", False), (1, "s/*", True)], id="a wide complete one"),
        pytest.param("s/*", [(1, "s/a", True), (2, "s/b", True)], id="wider than what is complete"),
        pytest.param("s/a", [(1, "s/a", False), (2, "s/*", False)], id="two incomplete"),
        pytest.param("s/a", [(0, "s/a", True), (1, "s/a", True)], id="complete here and there"),
        pytest.param("s/a", [(0, "s/a", False), (1, "s/a", True)], id="complete there"),
        pytest.param("s/a", [(0, "s/a", True), (1, "s/a", False)], id="complete here"),
        pytest.param("@s/a", [(1, "@s/*", True), (2, "@s/a", False)], id="verbatim"),
    ],
)
def test_a_query_is_answered_as_through_connected_routers(team, stack, asked, served):
    """Best matching, all and all complete reach the same queryables, each once, as without the bridge."""
    endpoints = [free_endpoint() for _ in team]
    for n, endpoint in enumerate(endpoints):
        closing(stack, plain_session("router", listen=(endpoint,), connect=tuple(endpoints[:n])))
    plain = [closing(stack, plain_session("client", connect=(endpoint,))) for endpoint in endpoints]
    asker = closing(stack, plain_session("client", connect=(endpoints[0],)))
    expected = asked_everywhere(plain, asker, served, asked)
    asker = team[0].node()
    asked_everywhere([robot.node() for robot in team], asker, served, asked)
    # What is there may be known before it is that it is complete: then its key is declared anew.
    wait_until(lambda: to_each_target(asker, asked) == expected, what=f"answers {expected}")


def test_one_of_several_complete_queryables_answers_the_best_match(team):
    """Two robots that both have everything: either one is asked, as by a router, and all where all are meant."""
    served = [(1, "s/a", True), (2, "s/a", True)]
    best, *rest = asked_everywhere([robot.node() for robot in team], team[0].node(), served, "s/a")
    assert len(best) == 1
    assert rest == [["1 s/a", "2 s/a"]] * 2


def test_a_reply_has_the_priority_of_its_query(pair):
    """Priority and express of a query hold on the other side too, and come back with its replies."""
    serve(pair[1].node(), "s/a", lambda query: query.reply("s/a", "x"))
    wait_answering(pair[0], 1)
    (reply,) = pair[0].node().get("s/a", priority=zenoh.Priority.REAL_TIME, express=True, timeout=5.0)
    assert (reply.ok.priority, reply.ok.express) == (zenoh.Priority.REAL_TIME, True)


def test_a_query_that_is_never_answered_ends_with_the_askers_timeout(pair):
    """Nothing is kept here longer than the asker waits."""
    kept = []
    pair[1].node().declare_queryable("s/mute", zenoh.handlers.Callback(kept.append, indirect=False))
    wait_answering(pair[0], 1)
    pair[0].node().get("s/mute", timeout=0.2)
    wait_until(lambda: kept, what="the query")
    directions = (pair[0].bridge._outward, pair[1].bridge._inward)
    wait_until(lambda: not any(queries.pending for queries in directions), what="its end")


def test_a_query_whose_asker_has_gone_ends_with_its_answer(pair):
    """An asker that leaves holds nothing up."""
    kept = []
    pair[1].node().declare_queryable("s/slow", zenoh.handlers.Callback(kept.append, indirect=False))
    wait_answering(pair[0], 1)
    asker = pair[0].node()
    asker.get("s/slow", timeout=60.0)
    wait_until(lambda: kept, what="the query")
    asker.close()
    with kept.pop() as query:
        query.reply("s/slow", "x")
    del query
    wait_until(lambda: not pair[0].bridge._outward.pending, what="its end")


def test_when_it_is_not_known_how_was_asked_everybody_is(pair):
    """Where the wire is not understood, queries to what was known before still cross."""
    serve(pair[1].node(), "s/a", lambda query: query.reply("s/a", "x"))
    wait_answering(pair[0], 1)
    for robot in pair:
        for declarations in (robot.bridge._mirroring._apps, robot.bridge._mirroring._others):
            declarations._table.read(frame(b"\x0a"), inward=True)
    assert list(answers(pair[0].node(), "s/a")) == ["x"]


@pytest.fixture
def executor(stack):
    made = SerialExecutor("test")
    stack.callback(made.close, 1.0)
    return made


def near_side(stack):
    """Declarations that nobody else follows, and where their apps connect."""
    endpoint = free_endpoint()
    mesh = MeshConfig(listen=(free_endpoint(),), scouting=False)
    near = open_sides(AppConfig(listen=(endpoint,)), mesh, stack).apps
    # Its routers have worked out their routes, which the bridge waits for, too: before, queries end without an answer.
    assert near.keeps_source
    return near, endpoint


def open_fence():
    """A fence that nobody has to wait at: whoever wakes it has looked."""

    def look():
        fence.begin()
        fence.end()

    fence = Fence(look)
    return fence


def declared(stack, far, executor, fence):
    """A mirrored queryable for `service/a`, and what asks there."""
    near, endpoint = near_side(stack)
    nothing_held = Barrier(near, near, fence, executor)
    queries = Queries(
        near,
        far,
        executor,
        fence,
        Direction(("**",), ()),
        dropped=lambda _: False,
        numbered=lambda _: True,
        ahead=(nothing_held, nothing_held),
    )
    queries.update({"service/a": False})
    stack.callback(queries.close)
    asker = closing(stack, plain_session("client", connect=(endpoint,)))
    querier = asker.declare_querier("service/a")
    wait_until(lambda: querier.matching_status.matching, what="the queryable")
    return queries, asker


def test_too_many_queries_are_answered_with_an_error(stack, executor, monkeypatch):
    """Beyond its bound a query is refused with a reason instead of waiting for nobody."""
    monkeypatch.setattr(queries_module, "BOUNDS", replace(BOUNDS, queries=0))
    _, asker = declared(stack, closing(stack, plain_session("peer")), executor, open_fence())
    assert list(answers(asker, "service/a")) == ["error: too many queries under way"]


def test_a_closed_far_side_is_an_error_and_ends_the_query(stack, executor):
    """A session that cannot ask any more answers with Zenoh's reason."""
    far = plain_session("peer")
    queries, asker = declared(stack, far, executor, open_fence())
    far.close()
    (answer,) = answers(asker, "service/a")
    assert answer.startswith("error: ")
    wait_until(lambda: not queries.pending, what="its end")


@pytest.mark.parametrize(("patience", "loses"), [(60.0, False), (0.0, True)], ids=["it waits", "it cannot"])
def test_who_answers_faster_than_answers_are_handed_on_waits(stack, monkeypatch, caplog, patience, loses):
    """As at a router. What finds no place even so is said to be lost."""
    monkeypatch.setattr(queries_module, "TUNING", replace(TUNING, reply_waits=patience))
    endpoint, executor, told = free_endpoint(), SerialExecutor("test", 8), []
    stack.callback(executor.close, 1.0)
    far = closing(stack, plain_session("peer", listen=(endpoint,)))
    service = closing(stack, plain_session("peer", connect=(endpoint,)))

    go, busy, ended = threading.Event(), threading.Event(), threading.Event()

    def answer(query):
        executor.insist(lambda: (busy.set(), go.wait(60.0)))
        assert busy.wait(60.0)
        with query:
            for number in range(50):
                query.reply(f"service/a/{number}", b"x")

    queryable = service.declare_queryable("service/a", zenoh.handlers.Callback(answer, indirect=False))
    querier = far.declare_querier("service/a")
    wait_until(lambda: querier.matching_status.matching, what="the service")
    _, asker = declared(stack, far, executor, open_fence())
    handler = zenoh.handlers.Callback(lambda reply: told.append(str(reply.ok.key_expr)), ended.set, indirect=False)
    asker.get("service/a", handler, timeout=60.0, accept_replies=zenoh.ReplyKeyExpr.ANY)
    wait_until(lambda: executor.refused + len(executor._jobs) >= (50 if loses else 8), what="more than finds room")
    go.set()
    assert ended.wait(60.0)
    assert len(told) == 50 - executor.refused
    assert caplog.text.count("a reply is lost") == executor.refused
    assert (executor.refused > 0) is loses
    queryable.undeclare()


def test_a_query_waits_for_what_was_declared_before_it(stack, executor):
    """It is asked on when all that is mirrored, not sooner."""
    fence = Fence(lambda: None)
    queries, asker = declared(stack, closing(stack, plain_session("peer")), executor, fence)
    asker.get("service/a", timeout=30.0)
    wait_until(lambda: queries.pending, what="the query")
    assert not queries.crossed
    fence.begin()
    fence.end()
    wait_until(lambda: queries.crossed, what="it to cross")


def test_a_service_that_does_not_answer_leaves_room_for_others(stack, executor, monkeypatch):
    """However many ask it."""
    monkeypatch.setattr(queries_module, "BOUNDS", replace(BOUNDS, queries=8, queries_of_one=5))
    queries, asker = declared(stack, closing(stack, plain_session("peer")), executor, Fence(lambda: None))
    queries.update({"service/a": False, "service/b": False})
    querier = asker.declare_querier("service/b")
    wait_until(lambda: querier.matching_status.matching, what="the other queryable")
    asked = [asker.get("service/a", timeout=60.0) for _ in range(5)]
    wait_until(lambda: queries.pending == 5, what="as many queries as may come to one")
    assert list(answers(asker, "service/a")) == ["error: too many queries under way"]
    asked.append(asker.get("service/b", timeout=60.0))
    wait_until(lambda: queries.pending == 6, what="one to another")


def test_a_query_that_waits_holds_up_no_answers_to_others(stack, executor):
    """What was asked on before is answered meanwhile."""
    endpoint, held = free_endpoint(), []
    far = closing(stack, plain_session("peer", listen=(endpoint,)))
    service = closing(stack, plain_session("peer", connect=(endpoint,)))
    queryable = service.declare_queryable("service/a", zenoh.handlers.Callback(held.append, indirect=False))
    querier = far.declare_querier("service/a")
    wait_until(lambda: querier.matching_status.matching, what="the service")
    fence = Fence(lambda: None)
    queries, asker = declared(stack, far, executor, fence)
    first = asker.get("service/a", timeout=60.0)
    wait_until(lambda: queries.pending == 1, what="the first query")
    fence.begin()
    fence.end()
    wait_until(lambda: held, what="the service to be asked")
    second = asker.get("service/a", timeout=60.0)
    wait_until(lambda: queries.pending == 2, what="the second query")
    held[0].reply("service/a", "x")
    held[0].drop()
    assert [reply.ok.payload.to_string() for reply in first] == ["x"]
    assert queries.pending == 1
    del queryable, second
