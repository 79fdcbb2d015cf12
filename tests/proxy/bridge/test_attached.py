"""Threads that Python does not start itself stay known to it once they are attached."""

import threading

import zenoh

from proxy.bridge.attached import attach
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_a_thread_of_zenoh_keeps_its_state_between_callbacks(stack):
    """What a callback leaves in thread-local storage the next one on that thread finds."""
    endpoint = free_endpoint()
    local, found = threading.local(), []

    def take(_):
        attach()
        local.count = getattr(local, "count", 0) + 1
        found.append(local.count)

    listener = closing(stack, plain_session("peer", listen=(endpoint,)))
    listener.declare_subscriber("k", zenoh.handlers.Callback(take, indirect=False))
    heard = Heard(listener, "k")
    speaker = closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_until(lambda: speaker.put("k", "x") or len(heard.samples) >= 200, what="many samples")
    assert max(found) > 1
