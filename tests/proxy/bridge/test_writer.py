"""Samples are written as they are; what happens on slow links is in test_egress and test_patience."""

import pytest
import zenoh

from proxy.bridge import keys
from proxy.bridge.demand import Demand
from proxy.bridge.sample import Held
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.writer import Writer
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until


@pytest.fixture
def sessions(stack):
    """One that writes and one that hears."""
    endpoint = free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    return mesh, closing(stack, plain_session("peer", connect=(endpoint,)))


@pytest.mark.parametrize("broadcast", [False, True])
def test_a_sample_is_published_by_the_publisher_of_its_key_or_by_the_session(sessions, broadcast):
    """As it is, with the timestamp it leaves with; a droppable one says so."""
    mesh, peer = sessions
    made, heard = Heard(mesh, "made"), Heard(peer, "made")
    wait_matching(mesh, "made")
    mesh.put("made", "x", attachment=b"a", encoding="text/plain;s", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: made.samples and heard.samples, what="a sample to write")
    demand = Demand(mesh, lambda _: None, lambda: None, broadcast=broadcast)
    writer = Writer(mesh, demand, SendBuffers(mesh))
    stamp = mesh.new_timestamp()
    held = Held(made.samples[0], stamp, "made", 1, None)
    demand.note("made", held.sample, covered=False)
    demand.update()
    for droppable in (False, True):
        assert writer.write(held, droppable=droppable)
    wait_until(lambda: len(heard.samples) == 3, what="both")
    for sample, control in zip(
        heard.samples[1:], (zenoh.CongestionControl.BLOCK, zenoh.CongestionControl.DROP), strict=True
    ):
        assert (sample.payload.to_string(), sample.attachment.to_bytes(), sample.timestamp) == ("x", b"a", stamp)
        assert (str(sample.encoding), sample.congestion_control) == ("text/plain;s", control)
    demand.close()


def test_what_nobody_wants_is_not_broadcast(sessions):
    """On the air Zenoh does not see to that itself; it counts as written."""
    mesh, _ = sessions
    made = Heard(mesh, "made")
    mesh.put("made", "x")
    wait_until(lambda: made.samples, what="a sample to write")
    demand = Demand(mesh, lambda _: None, lambda: None, broadcast=True)
    writer = Writer(mesh, demand, SendBuffers(mesh))
    demand.note("made", made.samples[0], covered=False)
    demand.update()
    mesh.close()
    assert writer.write(Held(made.samples[0], None, "made", 1, None), droppable=False)


def test_a_copy_whose_key_is_longer_than_zenoh_takes_is_refused(sessions):
    """Copies travel below a key of Sendworthy's own; a panic ended the daemon."""
    mesh, _ = sessions
    made, key = Heard(mesh, "*"), "k" * keys.LONGEST
    mesh.put(key, "x")
    wait_until(lambda: made.samples, what="a sample to write")
    demand = Demand(mesh, lambda _: None, lambda: None)
    writer = Writer(mesh, demand, SendBuffers(mesh))
    assert not writer.write(Held(made.samples[0], None, key, 1, None, "ab12cd34"), droppable=False)
    assert writer.write(Held(made.samples[0], None, "k", 1, None, "ab12cd34"), droppable=False)
