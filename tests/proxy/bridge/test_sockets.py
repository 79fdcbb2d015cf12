"""Links are known when they come and go, without being listed all the time."""

from proxy.bridge.sessions import mesh_options, open_session
from proxy.bridge.sockets import Sockets
from proxy.bridge.tuning import TUNING
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_links_that_come_and_go_are_news(stack, now):  # noqa: ARG001 - no time passes
    """Zenoh tells of them; while it tells of none nothing is listed."""
    endpoint = free_endpoint()
    options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
    sockets = Sockets(closing(stack, open_session(options, "mesh")))
    assert not sockets.refresh() or not sockets.ends
    node = closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(lambda: (sockets.refresh(), sockets.ends)[1], what="the link")
    assert [zid for zid, _ in sockets.ends] == [str(node.zid())]
    assert not sockets.refresh()
    node.close()
    wait_until(lambda: sockets.refresh() and not sockets.ends, what="the end of the link")


def test_links_are_listed_now_and_then_in_any_case(stack, now):
    """Whatever was told of them: then the same links are no news."""
    endpoint = free_endpoint()
    options = mesh_options([endpoint], [], scouting=False, interface="auto", zenoh_options={})
    session = closing(stack, open_session(options, "mesh"))
    sockets = Sockets(session)
    closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(lambda: (sockets.refresh(), sockets.ends)[1], what="the link")
    now[0] += TUNING.links_listed
    assert not sockets.refresh()
    assert len(sockets.ends) == 1
