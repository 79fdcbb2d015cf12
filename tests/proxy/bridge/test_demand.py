"""How many nodes of the mesh want a key."""

import pytest

from proxy.bridge import demand as demand_module
from proxy.bridge.demand import Demand
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until


@pytest.fixture
def mesh(stack):
    endpoint = free_endpoint()
    return closing(stack, plain_session("peer", listen=(endpoint,))), endpoint


@pytest.fixture
def events():
    return []


@pytest.fixture
def demand(stack, mesh, events):
    made = Demand(mesh[0], events.append, lambda: None)
    stack.callback(made.close)
    return made


def follow(demand, key, *, covered=True):
    demand.note(key, covered=covered)
    demand.update()


def test_an_unknown_key_is_assumed_to_be_wanted_once(demand):
    """Before anything is known a sample counts as transmitted once."""
    assert demand.copies("k") == 1


def test_matching_follows_the_subscribers(stack, mesh, demand, events):
    """A key nobody wants costs nothing; the core learns of each change, for covered keys only."""
    for key, covered in (("k", True), ("free", False)):
        follow(demand, key, covered=covered)
    assert demand.copies("k") == 0
    heard = Heard(closing(stack, plain_session("peer", connect=(mesh[1],))), "**")
    wait_until(lambda: demand.copies("k") == demand.copies("free") == 1, what="the subscriber")
    assert demand.wanted == 2
    heard.subscriber.undeclare()
    wait_until(lambda: demand.copies("k") == demand.copies("free") == 0, what="its end")
    assert [(event.key, event.matching) for event in events] == [("k", False), ("k", True), ("k", False)]


def test_copies_are_the_robots_that_say_they_want_it(demand):
    """Each robot counts once, however many of its subscriptions match; a gone one no longer counts."""
    demand.told("z1", ["k/*", "k/a"])
    demand.told("z2", ["**"])
    demand.told("z3", ["other"])
    assert demand.copies("k/a") == 2
    demand.told("z2", ())
    assert demand.copies("k/a") == 1


def test_relayed_copies_are_one_more_than_the_robots(mesh):
    """The way to the router, and from there to each robot."""
    demand = Demand(mesh[0], lambda _: None, lambda: None, relayed=True)
    assert demand.copies("k/a") == 1
    demand.told("z1", ["k/*"])
    demand.told("z2", ["**"])
    assert demand.copies("k/a") == 3


def test_keys_are_followed_once_and_up_to_a_bound(demand, monkeypatch, events):
    """The same key again changes nothing; beyond the bound a key stays unknown."""
    monkeypatch.setattr(demand_module, "MOST", 1)
    for key in ("a", "a", "b"):
        follow(demand, key)
    assert [event.key for event in events] == ["a"]
    assert (demand.copies("a"), demand.copies("b")) == (0, 1)


def test_the_cache_is_bounded(demand, monkeypatch):
    """Many keys do not fill the memory."""
    monkeypatch.setattr(demand_module, "_CACHED", 3)
    demand.told("z1", ["k/*"])
    assert [demand.copies(f"k/{i}") for i in range(10)] == [1] * 10
    assert len(demand._counts) <= 3
