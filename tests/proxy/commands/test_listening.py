"""Listening to samples for a while."""

import pytest
import zenoh

from proxy.commands import listening
from proxy.commands.listening import Listener
from tests.proxy.nodes import free_endpoint, plain_session
from tests.waiting import wait_until


@pytest.fixture(scope="module")
def link():
    """A router, and a client of it that stamps what it publishes."""
    endpoint = free_endpoint()
    with (
        plain_session("router", listen=(endpoint,)) as here,
        plain_session("client", connect=(endpoint,), stamps=True) as there,
    ):
        yield here, there


@pytest.fixture
def key(request):
    """A key of this test alone."""
    return f"robot/{request.node.name}"


def listen(stack, session, key, listener):
    subscriber = session.declare_subscriber(key, zenoh.handlers.Callback(listener.take, indirect=False))
    stack.callback(subscriber.undeclare)


def published(link, key, listener, *payloads, **options):
    """Publish until the listener has heard something of it."""
    publisher = link[1].declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: publisher.matching_status.matching, what="the subscriber to be known")
    enough = listener.count + len(payloads)
    for payload in payloads:
        publisher.put(payload, **options)
    wait_until(lambda: listener.count >= enough or listener.over.is_set(), what="the samples")


def test_samples_are_kept_with_all_that_is_known(stack, link, key):
    """Key, payload, encoding, attachment, and who published it; deletes are no samples."""
    listener = Listener()
    listen(stack, link[0], key, listener)
    link[1].delete(key)
    published(link, key, listener, b"1", b"2", encoding="application/json", attachment=b"a")
    published(link, key, listener, b"3")
    first, second, third = listener.samples
    assert (first.key, first.payload, first.encoding, first.attachment) == (
        key,
        b"1",
        "application/json",
        b"a",
    )
    assert first.origin == second.origin == str(link[1].zid())
    assert third.attachment is None
    assert 0.0 < first.time <= second.time


def test_it_is_over_when_there_are_enough(stack, link, key):
    """What comes later is not taken."""
    listener = Listener(most=2)
    listen(stack, link[0], key, listener)
    published(link, key, listener, b"1", b"2", b"3", b"4")
    wait_until(listener.over.is_set, what="the end")
    assert ([each.payload for each in listener.samples], listener.full) == ([b"1", b"2"], False)


def test_memory_is_bounded(stack, link, key, monkeypatch):
    """When it is full, it is over; a recording is not kept in memory."""
    monkeypatch.setattr(listening, "MOST_BYTES", 10)
    listener, kept = Listener(), []
    recorder = Listener(add=kept.append)
    listen(stack, link[0], key, listener)
    listen(stack, link[0], key, recorder)
    published(link, key, recorder, *[b"12345"] * 5)
    wait_until(lambda: len(kept) == 5, what="all samples")
    assert (len(listener.samples), listener.full, listener.over.is_set()) == (2, True, True)
    assert (recorder.samples, recorder.full) == ([], False)


def test_it_is_over_when_nothing_can_be_kept(stack, link, key):
    """Such as on a full disk; it says why, and tries no more."""
    tried = []

    def full(sample):
        tried.append(sample)
        raise OSError("full")

    listener, other = Listener(add=full), Listener()
    listen(stack, link[0], key, listener)
    listen(stack, link[0], key, other)
    published(link, key, other, b"1", b"2")
    wait_until(listener.over.is_set, what="the end")
    assert (listener.count, len(tried), str(listener.failure)) == (0, 1, "full")


def test_when_it_was_stopped_nothing_is_taken(stack, link, key):
    """Not even what was on its way."""
    listener, other = Listener(), Listener()
    listen(stack, link[0], key, listener)
    listen(stack, link[0], key, other)
    listener.stop()
    published(link, key, other, b"1")
    assert (listener.count, other.samples[0].origin) == (0, str(link[1].zid()))
