"""What the rest of the bridge asks of one side, on real sessions."""

import pytest
import zenoh

from proxy.bridge.keys import CROSSING, INGRESS
from proxy.bridge.sides import open_sides
from proxy.config import AppConfig, MeshConfig
from tests.proxy.bridge.declarations.test_wire import frame
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until


@pytest.fixture
def endpoints():
    return free_endpoint(), free_endpoint()


@pytest.fixture
def opened(stack, endpoints):
    app, mesh = endpoints
    return open_sides(AppConfig(listen=(app,)), MeshConfig(listen=(mesh,), scouting=False), stack)


def test_subscribers_of_the_main_session_are_not_taken_for_those_of_others(stack, opened, endpoints):
    """Both are on the wire; it is settled when each of ours has its witness."""
    ours = Heard(opened.app, "ours")
    theirs = Heard(closing(stack, plain_session("client", connect=endpoints[:1])), "theirs")
    wait_until(lambda: set(opened.apps.declared("subscriber")) >= {"ours", "theirs"}, what="both on the wire")
    assert opened.apps.foreign_subscribers({"ours"}, 0.0) == {"theirs": False}
    assert not opened.apps.ask_witnesses()
    assert not opened.apps.unsettled(())
    del ours, theirs


def test_tokens_of_the_mirror_session_are_not_taken_for_those_of_others(stack, opened, endpoints):
    """On the mesh that session is a client, which is told its own."""
    token = opened.others.session.liveliness().declare_token("ours")
    peer = closing(stack, plain_session("peer", connect=endpoints[1:]))
    theirs = peer.liveliness().declare_token("theirs")
    wait_until(lambda: set(opened.others.declared("token")) == {"ours", "theirs"}, what="both on the wire")
    assert opened.others.foreign_tokens({"ours"}, 0.0) == {"theirs": False}
    assert opened.others.unsettled(())
    assert not opened.others.unsettled({"ours"})
    assert opened.apps.foreign_tokens((), 0.0) is opened.apps.declared("token")
    del token, theirs


def test_how_a_query_was_asked_is_known_until_it_is_taken(stack, opened, endpoints):
    """The next one of the same key and parameters is another one."""
    queries = []
    assert opened.apps.keeps_source, "routers have worked out their routes when this is known"
    served = opened.apps.session.declare_queryable("q", zenoh.handlers.Callback(queries.append, indirect=False))
    asker = closing(stack, plain_session("client", connect=endpoints[:1]))
    querier = asker.declare_querier("q")
    wait_until(lambda: querier.matching_status.matching, what="the queryable")
    asker.get("q?x=1", priority=zenoh.Priority.DATA_LOW, timeout=7.0)
    wait_until(lambda: queries, what="the query")
    seen, taken = opened.apps.query_options("q", "x=1"), opened.apps.take_query("q", "x=1")
    assert seen == taken
    assert (taken.priority, taken.timeout) == (zenoh.Priority.DATA_LOW, 7.0)
    assert opened.apps.take_query("q", "x=1").priority is None
    del served


@pytest.mark.parametrize(("side", "everything"), [("apps", CROSSING), ("others", INGRESS)])
def test_where_the_wire_is_not_understood_everything_counts_as_subscribed_to(opened, side, everything):
    """And that is news."""
    declarations = getattr(opened, side)
    edition = declarations.edition
    declarations._table.read(frame(b"\x0a"), inward=True)
    assert declarations.edition > edition
    assert declarations.foreign_subscribers((), 0.0).keys() == set(everything)
