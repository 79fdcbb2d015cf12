"""What comes from the mesh reaches the apps; who hears what is in test_bridge."""

import pytest
import zenoh

from proxy.bridge import keys
from proxy.bridge.delivery import Delivery
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.rules import Rules
from proxy.bridge.sample import Parcel
from proxy.config import BridgeConfig
from proxy.core.interface.events import SampleHeard
from proxy.core.protocol.messages import tag
from tests.proxy.nodes import Heard, closing, free_endpoint, pass_fence, plain_session, wait_matching
from tests.waiting import wait_until


def test_only_covered_samples_are_told_to_the_core(stack):
    """Everything is delivered; of covered samples the core learns key, size and, when stamped, origin and time."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    events = []
    delivery = Delivery(
        app, mesh, lambda key: key if key.startswith("covered") else None, Rules(BridgeConfig()), events.append
    )
    stack.callback(delivery.close)
    delivery.update({"**": False})
    node = closing(stack, plain_session("client", connect=(inside,)))
    heard = Heard(node, "**")
    pass_fence(node, app)
    other = closing(stack, plain_session("peer", connect=(endpoint,)))
    wait_matching(other, "**")
    for key, stamp in (("free", None), ("covered/a", None), ("covered/b", other.new_timestamp())):
        other.put(key, b"123", timestamp=stamp, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(heard.samples) == delivery.delivered == 3, what="all three")
    wait_until(lambda: len(events) == 2, what="the core to be told")
    assert [(type(e), e.key, e.size, e.origin) for e in events] == [
        (SampleHeard, "covered/a", 3, None),
        (SampleHeard, "covered/b", 3, str(other.zid())),
    ]
    assert (events[0].stamp is None, events[1].stamp > 1e9) == (True, True)


@pytest.mark.parametrize("numbered", [False, True])
def test_heartbeats_are_delivered_where_numbers_are(stack, numbered):
    """Whoever sends them, a robot without a daemon too; or neither them nor what they speak of."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    delivery = Delivery(app, mesh, lambda _: None, Rules(BridgeConfig()), lambda _: None, numbered=numbered)
    stack.callback(delivery.close)
    delivery.update({"a": False, "a/@adv/**": False})
    node = closing(stack, plain_session("client", connect=(inside,)))
    heard, beats = Heard(node, "a"), Heard(node, "a/@adv/**")
    pass_fence(node, app)
    other = closing(stack, plain_session("peer", connect=(endpoint,), stamps=True))
    publisher = other.declare_publisher("a")
    wait_until(lambda: publisher.matching_status.matching, what="the mirrored subscription")
    beat = other.declare_publisher(f"a/@adv/pub/{other.zid()}/{publisher.id.eid}/_")
    wait_until(lambda: beat.matching_status.matching, what="the other one")
    beat.put("heartbeat")
    publisher.put("x", source_info=zenoh.SourceInfo(publisher.id, 1))
    wait_until(lambda: heard.samples, what="the sample")
    assert (heard.samples[0].source_info is not None) == numbered
    assert len(beats.samples) == numbered


def test_a_covered_sample_that_is_denied_is_heard_all_the_same(stack):
    """It was on the air: the core learns of it, and the apps do not."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    events, rules = [], Rules(BridgeConfig.model_validate({"in": {"deny": ["a"]}}))
    delivery = Delivery(app, mesh, lambda key: key, rules, events.append)
    stack.callback(delivery.close)
    delivery.update({"*": False})
    node = closing(stack, plain_session("client", connect=(inside,)))
    heard = Heard(node, "*")
    pass_fence(node, app)
    publishers = [closing(stack, plain_session("peer", connect=(endpoint,))).declare_publisher(key) for key in "ab"]
    for publisher in publishers:
        wait_until(lambda publisher=publisher: publisher.matching_status.matching, what="the mirrored subscription")
        publisher.put("x")
    wait_until(lambda: len(events) == 2, what="both samples")
    wait_until(lambda: heard.samples, what="the one that is not denied")
    assert [str(sample.key_expr) for sample in heard.samples] == ["b"]
    assert (delivery.delivered, rules.describe()["in"]["samples"]) == (1, 1)


def test_a_copy_is_delivered_as_what_it_is_a_copy_of(stack):
    """Under its own key, unless it came before or no application wants it; the core learns nothing of its way."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    events = []
    delivery = Delivery(app, mesh, lambda key: key, Rules(BridgeConfig()), events.append, counts_each=lambda _: True)
    stack.callback(delivery.close)
    delivery.open()
    delivery.update({"alarm/*": False})
    node = closing(stack, plain_session("client", connect=(inside,)))
    heard = Heard(node, "**")
    pass_fence(node, app)
    other = closing(stack, plain_session("peer", connect=(endpoint,)))
    to = tag(str(mesh.zid()))
    for key in ("alarm/a", keys.kept(to, "alarm/a")):
        wait_matching(other, key)
    before, missed = other.new_timestamp(), other.new_timestamp()
    block = zenoh.CongestionControl.BLOCK
    other.put("alarm/a", "before", timestamp=before, congestion_control=block)
    wait_until(lambda: heard.samples, what="the first one")
    for key, text, stamp in (("alarm/a", "before", before), ("other/a", "unwanted", missed), ("alarm/a", "x", missed)):
        other.put(
            keys.kept(to, key),
            text,
            timestamp=stamp,
            attachment="with it",
            encoding="text/plain;s",
            priority=zenoh.Priority.DATA_HIGH,
            congestion_control=block,
        )
    other.delete(keys.kept(to, "alarm/a"), timestamp=other.new_timestamp(), congestion_control=block)
    wait_until(lambda: len(heard.samples) >= delivery.delivered >= 3, what="what was missed")
    _, sample, deletion = heard.samples
    assert [str(each.key_expr) for each in heard.samples] == ["alarm/a"] * 3
    assert (sample.payload.to_string(), sample.attachment.to_string()) == ("x", "with it")
    assert (str(sample.encoding), sample.priority) == ("text/plain;s", zenoh.Priority.DATA_HIGH)
    assert (sample.timestamp, deletion.kind) == (missed, zenoh.SampleKind.DELETE)
    assert (delivery.delivered, delivery.repeated, len(events)) == (3, 1, 1)


def test_what_is_new_waits_for_the_copies_of_a_robot_that_is_back(stack):
    """Where each sample counts; the core hears of it when it arrives. Nothing that waits is lost at the end."""
    endpoint, inside = free_endpoint(), free_endpoint()
    mesh = closing(stack, plain_session("peer", listen=(endpoint,)))
    app = closing(stack, plain_session("router", listen=(inside,)))
    events, waiting = [], HoldBack(lambda _: "")
    each = {"alarm/a"}.__contains__
    rules = Rules(BridgeConfig())
    delivery = Delivery(app, mesh, lambda key: key, rules, events.append, counts_each=each, hold_back=waiting)
    delivery.open()
    delivery.update({"*/a": False})
    node = closing(stack, plain_session("client", connect=(inside,)))
    heard = Heard(node, "**")
    pass_fence(node, app)
    other = closing(stack, plain_session("peer", connect=(endpoint,)))
    copies = keys.kept(tag(str(mesh.zid())), "alarm/a")
    for key in ("alarm/a", copies):
        wait_matching(other, key)
    waiting.lost("back")
    waiting.found("back")
    block = zenoh.CongestionControl.BLOCK
    missed = other.new_timestamp()
    for key, text, stamp in (("alarm/a", "new", None), ("image/a", "free", None), (copies, "missed", missed)):
        other.put(key, text, timestamp=stamp or other.new_timestamp(), congestion_control=block)
    wait_until(lambda: len(heard.samples) == 2, what="what does not wait")
    assert (delivery.delivered, [event.key for event in events]) == (2, ["alarm/a", "image/a"])
    ((held,),) = waiting._streams.values()
    assert isinstance(held.hand.args[0].sample, Parcel)  # what waits takes its own memory and no more
    delivery.close()
    wait_until(lambda: len(heard.samples) == 3, what="the rest")
    assert [sample.payload.to_string() for sample in heard.samples] == ["free", "missed", "new"]
