"""How many nodes of the mesh want a key."""

import threading
from contextlib import suppress
from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import demand as demand_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.demand import Demand
from tests.proxy.nodes import Heard, closing, free_endpoint, pass_fence, plain_session
from tests.waiting import wait_until


@pytest.fixture
def mesh(stack):
    endpoint = free_endpoint()
    return closing(stack, plain_session("peer", listen=(endpoint,))), endpoint


@pytest.fixture
def events():
    return []


@pytest.fixture
def broadcast():
    """Whether samples travel elsewhere."""
    return False


@pytest.fixture
def demand(stack, mesh, events, broadcast):
    """Whatever wakes it, it is updated on a thread of its own."""
    wake, ended = threading.Event(), threading.Event()
    made = Demand(mesh[0], events.append, wake.set, broadcast=broadcast)
    stack.callback(made.close)

    def update():
        while wake.wait() and not ended.is_set():
            wake.clear()
            made.update()

    thread = threading.Thread(target=update)
    thread.start()
    stack.callback(thread.join)
    stack.callback(wake.set)
    stack.callback(ended.set)
    return made


@pytest.fixture
def follow(mesh, demand):
    """Let the demand for a key be followed, as with its first sample."""
    made = Heard(mesh[0], "made")

    def follow_one(key, *, covered=True, **quality):
        before = len(made.samples)
        mesh[0].put("made", "x", **quality)
        wait_until(lambda: len(made.samples) > before, what="a sample")
        known = key in demand._matching
        demand.note(key, made.samples[-1], covered=covered)
        wait_until(lambda: known or key in demand._matching or key not in demand._seen, what="its demand")
        return made.samples[-1]

    return follow_one


def test_an_unknown_key_is_assumed_to_be_wanted_once(demand):
    """Before anything is known a sample counts as transmitted once."""
    assert demand.copies("k") == 1


def test_matching_follows_the_subscribers(stack, mesh, demand, events, follow):
    """A key nobody wants costs nothing; the core learns of each change, for covered keys only.

    Until it is known, somebody is taken to want it: what crosses meanwhile counts.
    """
    for key, covered in (("k", True), ("free", False)):
        follow(key, covered=covered)
    assert demand.copies("k") == 0
    heard = Heard(closing(stack, plain_session("peer", connect=(mesh[1],))), "**")
    wait_until(lambda: demand.copies("k") == demand.copies("free") == 1, what="the subscriber")
    assert demand.wanted == 2
    heard.subscriber.undeclare()
    wait_until(lambda: demand.copies("k") == demand.copies("free") == 0, what="its end")
    wait_until(lambda: len(events) >= 4, what="the core to be told")
    assert [(event.key, event.matching) for event in events] == [("k", wanted) for wanted in (True, False) * 2]


def test_the_core_learns_of_a_key_when_it_becomes_covered(demand, events, follow):
    """Another generation of specs may cover what none did before."""
    sample = follow("k", covered=False)
    assert not events
    for covered in (True, True, False, True):
        demand.note("k", sample, covered=covered)
    assert [(event.key, event.matching) for event in events] == [("k", False)] * 2


def test_copies_are_the_robots_that_say_they_want_it(demand):
    """Each robot counts once, however many of its subscriptions match; a gone one no longer counts."""
    demand.note_robot("z1", ["k/*", "k/a"])
    demand.note_robot("z2", ["**"])
    demand.note_robot("z3", ["other"])
    assert demand.copies("k/a") == 2
    assert demand.wanting("k/a") == {"z1", "z2"}
    demand.note_robot("z2", ())
    assert demand.copies("k/a") == 1
    assert demand.wanting("k/a") == {"z1"}


def test_relayed_copies_are_one_more_than_the_robots(mesh):
    """The way to the router, and from there to each robot."""
    demand = Demand(mesh[0], lambda _: None, lambda: None, relayed=True)
    assert demand.copies("k/a") == 1
    demand.note_robot("z1", ["k/*"])
    demand.note_robot("z2", ["**"])
    assert demand.copies("k/a") == 3


def test_who_asks_for_what_takes_long_to_compare_wants_all(demand):
    """Zenoh took 20 s for such an expression, and each sample of the key waited for it."""
    demand.note_robot("z1", ["/".join(["**", "a"] * 10)])
    demand.note_robot("z2", ["**/a"])
    key = "/".join(["b"] * 40)
    assert demand.wanting(key) == {"z1"}
    assert demand.copies(key) == 1


def test_keys_are_followed_once_and_up_to_a_bound(demand, monkeypatch, events, follow):
    """The same key again changes nothing; beyond the bound a key stays unknown."""
    monkeypatch.setattr(demand_module, "BOUNDS", replace(BOUNDS, demanded_keys=1))
    for key in ("a", "a", "b"):
        follow(key)
    assert [event.key for event in events] == ["a"] * 2
    assert (demand.copies("a"), demand.copies("b")) == (0, 1)


def test_the_cache_is_bounded(demand, monkeypatch):
    """Many keys do not fill the memory."""
    monkeypatch.setattr(demand_module, "BOUNDS", replace(BOUNDS, keys=3))
    demand.note_robot("z1", ["k/*"])
    assert [demand.copies(f"k/{i}") for i in range(10)] == [1] * 10
    assert len(demand._counts) <= 3


@pytest.mark.parametrize("broadcast", [True])
def test_in_broadcast_one_transmission_is_for_all(stack, mesh, demand, follow):
    """However many want a key; when it is known that none does, the bridge itself must be silent."""
    demand.note_robot("z1", ["k"])
    demand.note_robot("z2", ["k"])
    assert (demand.copies("k"), demand.silent("k")) == (1, False)
    follow("k")
    assert (demand.copies("k"), demand.silent("k"), demand.outlet("k")) == (0, True, None)
    heard = Heard(closing(stack, plain_session("peer", connect=(mesh[1],))), "k")
    wait_until(lambda: demand.copies("k") == 1, what="the subscriber")
    assert not demand.silent("k")
    assert not heard.samples


def test_in_broadcast_nobody_is_silent_who_is_wanted_by_now(stack, mesh, events):
    """Although nobody has updated since: that takes long with thousands of keys, and their samples were lost."""
    demand = Demand(mesh[0], events.append, lambda: None, broadcast=True)
    stack.callback(demand.close)
    made = Heard(mesh[0], "made")
    mesh[0].put("made", "x")
    wait_until(lambda: made.samples, what="a sample")
    demand.note("k", made.samples[0], covered=True)
    demand.update()
    assert demand.silent("k")
    other = closing(stack, plain_session("peer", connect=(mesh[1],)))
    heard = Heard(other, "k")
    pass_fence(other, mesh[0])
    assert not demand.silent("k")
    del heard


@pytest.mark.parametrize("broadcast", [True])
def test_what_cannot_be_broadcast_counts_once_for_each_robot(demand):
    """It goes by the mesh."""
    for robot in ("z1", "z2"):
        demand.note_robot(robot, ["@own/**", "k/@adv/**"])
    assert (demand.copies("@own/k"), demand.copies("k/@adv/pub/1")) == (2, 1)


def test_in_unicast_zenoh_itself_is_silent(demand, follow):
    """A key nobody wants is published all the same: Zenoh knows best."""
    follow("k")
    assert (demand.copies("k"), demand.silent("k")) == (0, False)


def test_an_outlet_publishes_as_the_first_sample_did(stack, mesh, demand, follow):
    """It suits samples of that quality of service; a key that is not followed has none."""
    plain = follow("k")
    urgent = {"priority": zenoh.Priority.REAL_TIME, "congestion_control": zenoh.CongestionControl.BLOCK}
    other = follow("urgent", **urgent, express=True)
    heard = Heard(closing(stack, plain_session("peer", connect=(mesh[1],))), "urgent")
    wait_until(lambda: demand.copies("urgent") == 1, what="the subscriber")
    outlet = demand.outlet("urgent")
    assert outlet.suits(other)
    assert not outlet.suits(plain)
    assert demand.outlet("k").suits(plain)
    assert demand.outlet("never seen") is None
    outlet.publisher.put("x")
    wait_until(lambda: heard.samples, what="the sample")
    (sample,) = heard.samples
    assert (sample.priority, sample.congestion_control, sample.express) == (*urgent.values(), True)


def test_it_closes_while_a_sample_is_being_published(stack, mesh, demand, follow):
    """Zenoh refuses to undeclare a publisher that is in use."""
    heard = Heard(closing(stack, plain_session("peer", connect=(mesh[1],))), "k")
    follow("k", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: demand.copies("k") == 1, what="the subscriber")
    publisher, ended = demand.outlet("k").publisher, threading.Event()

    def publish():
        with suppress(zenoh.ZError, RuntimeError):
            while not ended.is_set():
                publisher.put(bytes(2_000_000))

    thread = threading.Thread(target=publish)
    stack.callback(thread.join)
    stack.callback(ended.set)
    thread.start()
    wait_until(lambda: heard.samples, what="the first of them")
    demand.close()
    assert demand.outlet("k") is None
