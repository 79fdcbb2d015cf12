"""Robots that start find out whether their name is taken."""

from dataclasses import replace

from proxy import clock
from proxy.bridge import keys, naming
from proxy.bridge.naming import Naming
from tests.proxy.nodes import closing, free_endpoint, plain_session


def test_a_name_that_is_taken_is_said_loudly_by_the_newcomer(stack, caplog, monkeypatch):
    """It runs under another name."""
    monkeypatch.setattr(naming, "TUNING", replace(naming.TUNING, name_wait=60.0))
    endpoint = free_endpoint()
    first = closing(stack, plain_session("peer", listen=(endpoint,)))
    _token = first.liveliness().declare_token(keys.alive("r1", str(first.zid())))
    second = closing(stack, plain_session("peer", connect=(endpoint,)))
    name = Naming(second, "r1").name()
    assert name == f"r1-{str(second.zid())[:4]}"
    assert f"runs as '{name}'" in caplog.text


def test_a_name_that_is_free_is_kept(stack):
    """When it was listened for long enough nothing is waited for."""
    made = Naming(closing(stack, plain_session("peer")), "r7")
    made._until = clock.monotonic()
    assert made.name() == "r7"
