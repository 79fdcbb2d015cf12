"""Mirror sessions are told exactly what others declare, on real sessions."""

from dataclasses import replace

import pytest
import zenoh

from proxy.bridge.declarations import mirror_session
from proxy.bridge.declarations.mirror_session import TUNING
from proxy.bridge.sides import open_sides
from proxy.config import AppConfig, MeshConfig
from proxy.errors import SessionError
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def sides(stack):
    app, mesh = free_endpoint(), free_endpoint()
    opened = open_sides(AppConfig(listen=(app,)), MeshConfig(listen=(mesh,), scouting=False), stack)
    return opened, app, mesh


def drop(query):
    query.drop()


def test_what_the_mirror_session_mirrors_does_not_hide_or_keep_what_an_app_declares(stack):
    """The same queryable and token, mirrored and of an app: the app's is known for exactly as long as it exists."""
    opened, endpoint, _ = sides(stack)
    for mode in ("client", "peer"):
        app = closing(stack, plain_session(mode, connect=(endpoint,)))
        mirrored = opened.apps.session.declare_queryable("q/*", drop)
        token = opened.apps.session.liveliness().declare_token("t")
        own, alive = app.declare_queryable("q/*", drop, complete=True), app.liveliness().declare_token("t")
        wait_until(lambda: opened.apps.declared("queryable") == {"q/*": True}, what=f"the queryable of a {mode}")
        wait_until(lambda: opened.apps.declared("token") == {"t": False}, what=f"the token of a {mode}")
        own.undeclare()
        alive.undeclare()
        wait_until(lambda: not opened.apps.declared("queryable"), what=f"the end of the queryable of a {mode}")
        wait_until(lambda: not opened.apps.declared("token"), what=f"the end of the token of a {mode}")
        mirrored.undeclare()
        token.undeclare()


def test_on_the_mesh_the_mirror_session_knows_queryables_and_tokens_of_peers(stack):
    """Those of each peer are known while any peer has them, whatever the mirror session itself declares."""
    opened, _, endpoint = sides(stack)
    peers = [closing(stack, plain_session("peer", connect=(endpoint,))) for _ in range(2)]
    mirrored = opened.others.session.declare_queryable("q", drop)
    queryables = [peer.declare_queryable("q", drop) for peer in peers]
    tokens = [peer.liveliness().declare_token("@ros2_lv/t") for peer in peers]
    wait_until(lambda: opened.others.declared("queryable") == {"q": False}, what="the queryable")
    wait_until(lambda: opened.others.declared("token") == {"@ros2_lv/t": False}, what="the token")
    queryables[0].undeclare()
    tokens[1].undeclare()
    peers[1].close()
    wait_until(lambda: not opened.others.declared("queryable"), what="the end of the queryable")
    tokens[0].undeclare()
    wait_until(lambda: not opened.others.declared("token"), what="the end of the token")
    mirrored.undeclare()


def test_a_mirror_session_that_is_not_told_everything_says_so(stack, monkeypatch, caplog):
    """When its interests do not pass as expected, nobody relies on what it is told."""
    monkeypatch.setattr(mirror_session, "EVERYTHING", "something/else")
    monkeypatch.setattr(mirror_session, "TUNING", replace(TUNING, interests_timeout=0.01))
    opened, _, _ = sides(stack)
    assert opened.others._table.broken
    assert not opened.apps._table.broken
    assert "everything is bridged" in caplog.text


def test_on_the_mesh_the_mirror_session_knows_subscribers_and_all_verbatim_keys(stack):
    """Whatever chunk begins with `@`, and without asking for it by name."""
    opened, _, endpoint = sides(stack)
    peer = closing(stack, plain_session("peer", connect=(endpoint,)))
    kept = [
        peer.declare_subscriber("a/@one/b", zenoh.handlers.Callback(print, indirect=False)),
        peer.declare_queryable("@two/*", drop, complete=True),
        peer.liveliness().declare_token("@three"),
    ]
    wait_until(lambda: opened.others.declared("subscriber") == {"a/@one/b": False}, what="the subscriber")
    wait_until(lambda: opened.others.declared("queryable") == {"@two/*": True}, what="the queryable")
    wait_until(lambda: opened.others.declared("token") == {"@three": False}, what="the token")
    for each in kept:
        each.undeclare()
    for kind in ("subscriber", "queryable", "token"):
        wait_until(lambda kind=kind: not opened.others.declared(kind), what=f"the end of the {kind}")


def test_nothing_is_missed_under_churn(stack):
    """After hundreds of declarations by two apps at once the table holds what is left of them."""
    opened, endpoint, _ = sides(stack)
    apps = [closing(stack, plain_session("client", connect=(endpoint,))) for _ in range(2)]
    kept = {}
    for i in range(150):
        for n, app in enumerate(apps):
            subscriber = app.declare_subscriber(f"s/{n}/{i}", zenoh.handlers.Callback(print, indirect=False))
            if i % 10:
                subscriber.undeclare()
            else:
                kept[f"s/{n}/{i}"] = subscriber
    wait_until(lambda: set(opened.apps.declared("subscriber")) == set(kept), what="the remaining subscribers")


def test_a_closed_mirror_session_takes_back_what_it_declared(stack):
    """Apps no longer see what the mirror session mirrored."""
    opened, endpoint, _ = sides(stack)
    app = closing(stack, plain_session("client", connect=(endpoint,)))
    token = opened.apps.session.liveliness().declare_token("t")
    wait_until(lambda: list(app.liveliness().get("t", timeout=5.0)), what="the token")
    opened.apps.close()
    wait_until(lambda: not list(app.liveliness().get("t", timeout=5.0)), what="its end")
    del token


def test_a_session_that_refuses_its_own_mirror_session_is_an_error_that_says_what_to_do(stack, tmp_path):
    """A daemon must be in its own dictionary of users."""
    users = tmp_path / "users"
    users.write_text("other:secret\n")
    auth = {"usrpwd": {"user": "me", "password": "secret", "dictionary_file": str(users)}}
    mesh = MeshConfig(listen=(free_endpoint(),), scouting=False, zenoh={"transport": {"auth": auth}})
    with pytest.raises(SessionError, match=r"^mesh\.zenoh: .* in its own dictionary_file too: mirror session: "):
        open_sides(AppConfig(listen=(free_endpoint(),)), mesh, stack)
