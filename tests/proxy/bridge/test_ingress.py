"""What enters on the app side; who hears what is in test_bridge."""

import zenoh

from proxy.bridge import ingress as ingress_module
from proxy.core.events import SamplesPassed
from tests.proxy.nodes import Heard
from tests.waiting import wait_until


def test_no_more_is_held_than_the_bound(pair, monkeypatch):
    """When the core does not answer, samples beyond the bound are dropped, counted, and local apps still hear all."""
    monkeypatch.setattr(ingress_module, "MOST_HELD", 3)
    local = Heard(pair[0].node(), "covered/**")
    publisher = pair[0].node()
    for i in range(5):
        publisher.put("covered/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(local.samples) == 5, what="local delivery")
    wait_until(lambda: pair[0].posted(SamplesPassed), what="the count")
    assert len(pair[0].asked) == pair[0].bridge.describe()["held"] == 3
    (dropped,) = pair[0].posted(SamplesPassed)
    assert (dropped.reason, dropped.count) == ("dropped:overflow", 2)


def test_a_delete_of_a_covered_key_is_marked(pair):
    """The core is told that it is a delete."""
    pair[0].node().delete("covered/a")
    wait_until(lambda: pair[0].asked, what="the delete")
    assert pair[0].asked[0].delete


def test_apps_stamps_are_named_and_ours_are_not(pair):
    """`origin` is the id an app stamped with, None for what the daemon stamps itself."""
    stamping = pair[0].node(stamps=True)
    stamping.put("covered/a", "x")
    pair[0].node().put("covered/b", "x")
    wait_until(lambda: len(pair[0].asked) == 2, what="both samples")
    assert {event.key: event.origin for event in pair[0].asked} == {
        "covered/a": str(stamping.zid()),
        "covered/b": None,
    }


def test_peers_on_the_app_side_are_heard_once(pair):
    """Peer-mode apps of one robot hear each other directly, and the daemon hears each sample once."""
    local = Heard(pair[0].node("peer"), "covered/**")
    publisher = pair[0].node("peer")
    wait_until(lambda: "covered/**" in pair[0].bridge.describe()["subscriptions"], what="the subscription")
    probe = publisher.declare_publisher("covered/a")
    wait_until(lambda: probe.matching_status.matching, what="the peers to know each other")
    probe.put("x")
    wait_until(lambda: local.samples and pair[0].asked, what="the sample")
    publisher.put("covered/end", "x")
    wait_until(lambda: "covered/end" in [event.key for event in pair[0].asked], what="the last sample")
    assert [event.key for event in pair[0].asked] == ["covered/a", "covered/end"]


def test_what_left_for_the_mesh_and_came_back_around_the_daemons_stays(pair):
    """A sample with our own stamp is one that we stamped when it left: it is counted, and does not go round."""
    publisher = pair[0].node()
    publisher.put("covered/a", "back", timestamp=pair[0].mesh.new_timestamp())
    publisher.put("covered/b", "new")
    wait_until(lambda: pair[0].asked, what="the new one")
    assert [sample.key for sample in pair[0].asked] == ["covered/b"]
    assert pair[0].bridge.describe()["returned"] == 1
