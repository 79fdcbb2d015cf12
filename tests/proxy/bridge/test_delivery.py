"""What comes from the mesh reaches the apps; who hears what is in test_bridge."""

import zenoh

from proxy.bridge.delivery import Delivery
from proxy.core.events import SampleHeard
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_only_covered_samples_are_told_to_the_core(stack):
    """Everything is delivered; of covered samples the core learns key, size and, when stamped, origin and time."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    events = []
    delivery = Delivery(app, mesh, lambda key: key if key.startswith("covered") else None, events.append)
    stack.callback(delivery.close)
    delivery.update({"**": False})
    heard = Heard(closing(stack, plain_session("client", connect=(inside,))), "**")
    other = closing(stack, plain_session("peer", connect=(endpoint,)))
    probe = other.declare_publisher("**")
    wait_until(lambda: probe.matching_status.matching, what="the mirrored subscription")
    probe.undeclare()
    for key, stamp in (("free", None), ("covered/a", None), ("covered/b", other.new_timestamp())):
        other.put(key, b"123", timestamp=stamp, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(heard.samples) == 3, what="all three")
    assert delivery.delivered == 3
    assert [(type(e), e.key, e.size, e.origin) for e in events] == [
        (SampleHeard, "covered/a", 3, None),
        (SampleHeard, "covered/b", 3, str(other.zid())),
    ]
    assert (events[0].stamp is None, events[1].stamp > 1e9) == (True, True)
