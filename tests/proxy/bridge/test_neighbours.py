"""Daemons whose apps are joined know each other, on real sessions."""

import threading

from proxy.bridge.neighbours import Neighbours
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def daemon(stack, name, endpoint, own="0"):
    session = closing(stack, plain_session("router", connect=(endpoint,)))
    changed = threading.Event()
    made = Neighbours(session, name, own, changed.set)
    stack.callback(made.close)
    return made, session, changed


def test_of_those_that_are_joined_one_bridges(stack):
    """Both say so and whom they see; when one leaves the other one bridges, whichever it was."""
    endpoint = free_endpoint()
    closing(stack, plain_session("router", listen=(endpoint,)))
    (first, a, changed), (second, b, _) = (daemon(stack, name, endpoint) for name in ("r1", "r2"))
    wait_until(lambda: first.warnings() and second.warnings(), what="both to see the other")
    assert changed.is_set()
    assert (first.aside, second.aside) == (str(b.zid()) < str(a.zid()), str(a.zid()) < str(b.zid()))
    leading, following = (second, first) if first.aside else (first, second)
    assert "and this daemon bridges for both" in leading.warnings()[0]
    assert "and another daemon bridges for both" in following.warnings()[0]
    assert "link to robot r2 around the daemons" in first.warnings()[0]
    leading.close()
    wait_until(lambda: not following.warnings(), what="the end of the other")
    assert not following.aside


def test_a_daemon_that_sees_its_own_mesh_among_its_apps_stands_aside(stack):
    """Everything has a way around it then."""
    endpoint = free_endpoint()
    shared = closing(stack, plain_session("router", listen=(endpoint,)))
    alone, _, _ = daemon(stack, "r1", endpoint, own="12ab")
    token = shared.liveliness().declare_token("@sendworthy/r1/alive/12ab")
    wait_until(lambda: alone.aside, what="its own presence on the app side")
    assert "link to the mesh around the daemon" in alone.warnings()[0]
    token.undeclare()
    wait_until(lambda: not alone.aside and not alone.warnings(), what="its end")


def test_the_presence_of_another_robots_mesh_among_the_apps_is_said(stack):
    """A router of the apps that is linked to another daemon's mesh side doubles samples there: a warning, no more."""
    endpoint = free_endpoint()
    router = closing(stack, plain_session("router", listen=(endpoint,)))
    alone, _, _ = daemon(stack, "r1", endpoint)
    token = router.liveliness().declare_token("@sendworthy/r2/alive/34cd")
    wait_until(alone.warnings, what="the presence of another robot")
    assert "link to the daemon of robot r2" in alone.warnings()[0]
    assert not alone.aside
    token.undeclare()
    wait_until(lambda: not alone.warnings(), what="its end")


def test_alone_there_is_nothing_to_say(stack):
    """A daemon does not take itself for another."""
    alone, session, _ = daemon(stack, "r1", free_endpoint())
    tokens = [str(reply.ok.key_expr) for reply in session.liveliness().get("@sendworthy/**", timeout=5.0)]
    assert tokens == [f"@sendworthy/r1/app/{session.zid()}"]
    assert not alone.aside
    assert not alone.warnings()
