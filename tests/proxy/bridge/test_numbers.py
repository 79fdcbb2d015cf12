"""Advanced publishers number their samples: what their subscribers on another robot recover, and what not."""

import json
from datetime import timedelta

import pytest
import zenoh
import zenoh.ext

from proxy.bridge.declarations.tuning import TUNING
from proxy.core.interface.events import SamplesPassed
from proxy.core.model.mode import Mode
from tests.proxy.bridge import robots
from tests.proxy.bridge.robots import fence, fence_apps, wait_interest
from tests.proxy.nodes import Heard, closing, wait_matching
from tests.waiting import wait_until

NONE, ANY = zenoh.ConsolidationMode.NONE, zenoh.ReplyKeyExpr.ANY
HEARTBEAT = {"heartbeat": True, "periodic_queries": None}
PERIOD = 0.05
"""Of heartbeats and queries [s]."""
# The stubs promise seconds; the binding wants this.
PERIODIC = {"heartbeat": None, "periodic_queries": timedelta(seconds=PERIOD)}
LARGE = 100
"""Samples that are larger are lost on their way, those of `lossy` [B]."""
SMALL_PIECES = {"zenoh": {"transport": {"link": {"tx": {"batch_size": 500}}}}}
"""With these no reply can have source info."""


def lossy(stack, robot, *, stamps):
    """An application of `robot` whose large samples are lost before anybody gets them."""
    options = {
        "mode": "client",
        "connect": {"endpoints": [robot.app_endpoint]},
        "scouting": {"multicast": {"enabled": False}},
        "timestamping": {"enabled": stamps},
        "low_pass_filter": [
            {"messages": ["put"], "flows": ["egress"], "key_exprs": ["**"], "size_limit": LARGE},
        ],
    }
    return closing(stack, zenoh.open(zenoh.Config.from_json5(json.dumps(options))))


def publisher_of(app, key, cache=10):
    return zenoh.ext.declare_advanced_publisher(
        app,
        key,
        cache=zenoh.ext.CacheConfig(max_samples=cache),
        sample_miss_detection=zenoh.ext.MissDetectionConfig(heartbeat=PERIOD, sporadic_heartbeat=None),
        publisher_detection=True,
        congestion_control=zenoh.CongestionControl.BLOCK,
    )


class Recovered:
    """What an advanced subscriber of `robot` hears, and what it misses."""

    def __init__(self, robot, key, recovery, **options):
        self.heard, self.missed = [], []
        self.subscriber = zenoh.ext.declare_advanced_subscriber(
            robot.node(),
            key,
            lambda sample: self.heard.append(sample.payload.to_string()[:5]),
            recovery=zenoh.ext.RecoveryConfig(**recovery),
            **options,
        )
        self.listener = self.subscriber.sample_miss_listener(lambda miss: self.missed.append(miss.nb))

    def close(self):
        self.listener.undeclare()
        self.subscriber.undeclare()


def passed(robot, reason):
    return sum(event.count for event in robot.posted(SamplesPassed) if event.reason == reason)


def asked(robot):
    """Queries of the robot's apps that went to the mesh."""
    return robot.bridge.describe()["queries"]["outward"]


def wait_periods(pair, recovery, beats):
    """Wait until a subscriber on the first robot has been told of the numbers on the second, or has asked, repeatedly.

    Heartbeats are counted under `beats`.
    """
    count = (lambda: passed(pair[1], beats)) if recovery is HEARTBEAT else (lambda: asked(pair[0]))
    before = count()
    wait_until(lambda: count() > before + 4, what="heartbeats or queries")


def wait_cache(robot):
    """Wait until the apps of `robot` can ask another robot's cache."""
    wait_until(lambda: robot.bridge.describe()["queryables"]["outward"], what="the mirrored cache")
    fence_apps(robot)


@pytest.mark.parametrize("stamps", [False, True], ids=["numbers", "numbers and stamps"])
@pytest.mark.parametrize("recovery", [HEARTBEAT, PERIODIC], ids=["heartbeat", "periodic queries"])
def test_what_was_lost_is_recovered_once(pair, stack, stamps, recovery):
    """A gap and the last sample are fetched from the other robot, in order, and never again; nothing is missed."""
    app = lossy(stack, pair[1], stamps=stamps)
    publisher = publisher_of(app, "free/a")
    recovered = Recovered(pair[0], "free/a", recovery)
    wait_interest(pair[0], pair[1], keys=("free/a",))
    wait_matching(app, "free/a")
    wait_cache(pair[0])
    expected = ["0    ", "1 xxx", "2    ", "3 xxx"]
    for text in expected:
        publisher.put(text.ljust(2 * LARGE, "x") if "x" in text else text)
    wait_until(lambda: len(recovered.heard) >= 4, what="all of them")
    wait_periods(pair, recovery, "passed:no-spec")
    publisher.put("4    ")
    wait_until(lambda: "4    " in recovered.heard, what="the next one")
    assert recovered.heard == [*expected, "4    "]
    assert not recovered.missed
    recovered.close()
    publisher.undeclare()


@pytest.mark.parametrize("stamps", [False, True], ids=["numbers", "numbers and stamps"])
def test_a_late_joiner_that_recovers_hears_everything_once(pair, stack, stamps):
    """History, what is lost after it, and what comes then."""
    publisher = publisher_of(lossy(stack, pair[1], stamps=stamps), "free/a")
    for text in ("0", "1"):
        publisher.put(text)
    wait_cache(pair[0])
    history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
    recovered = Recovered(pair[0], "free/a", HEARTBEAT, history=history)
    wait_until(lambda: len(recovered.heard) == 2, what="the history")
    wait_interest(pair[0], pair[1], keys=("free/a",))
    publisher.put("2".ljust(2 * LARGE))
    wait_until(lambda: len(recovered.heard) == 3, what="the lost one")
    publisher.put("3")
    wait_until(lambda: len(recovered.heard) == 4, what="the next one")
    assert [text.strip() for text in recovered.heard] == ["0", "1", "2", "3"]
    assert not recovered.missed
    recovered.close()
    publisher.undeclare()


STRANGE = [None, b"", b"\x00", b"\x01more", b"x" * 100_000]


def test_what_a_cache_answers_comes_with_numbers_and_attachments(pair):
    """All kinds of attachments, small and in fragments."""
    publisher = publisher_of(pair[1].node(), "free/a", cache=100)
    sent = []
    for payload in (b"", b"small", b"y" * 200_000):
        for attachment in STRANGE:
            publisher.put(payload, attachment=attachment)
            sent.append((payload, attachment))
    wait_cache(pair[0])
    replies = pair[0].node().get("free/a/@adv/**", consolidation=NONE, accept_replies=ANY, timeout=10.0)
    samples = [reply.ok for reply in replies]
    assert [(bytes(sample.payload), bytes_of(sample.attachment)) for sample in samples] == sent
    assert [sample.source_info.source_sn for sample in samples] == list(range(len(sent)))
    assert {str(sample.source_info.source_id) for sample in samples} == {str(publisher.id)}
    publisher.undeclare()


def bytes_of(attachment):
    return None if attachment is None else bytes(attachment)


def test_deletes_are_answered_with_numbers(pair):
    """As a robot answers them whose applications can: those in Python cannot, and caches turn them into puts."""
    near = pair[1].bridge._inward._near
    session = pair[0].node()
    publisher, heard = session.declare_publisher("free/a"), Heard(session, "free/a")
    for attachment in STRANGE:
        publisher.delete(attachment=attachment, source_info=zenoh.SourceInfo(publisher.id, 7))
    wait_until(lambda: len(heard.samples) == len(STRANGE), what="deletes")

    def answer(query):
        with query:
            for sample in heard.samples:
                query.reply_del("free/a", attachment=near.attachment_of(sample))

    served = near.session.declare_queryable("free/a", zenoh.handlers.Callback(answer))
    wait_cache(pair[0])
    found = [reply.ok for reply in pair[0].node().get("free/a", consolidation=NONE, timeout=10.0)]
    assert [bytes_of(sample.attachment) for sample in found] == STRANGE
    assert all(sample.kind == zenoh.SampleKind.DELETE for sample in found)
    assert {str(sample.source_info.source_id) for sample in found} == {str(publisher.id)}
    served.undeclare()


def test_a_very_long_key_goes_without_numbers(pair):
    """There is no room for them where they would have to stand; the attachment is whole."""
    key = "free/" + "a" * TUNING.key_and_encoding
    publisher = publisher_of(pair[1].node(), key)
    publisher.put("x", attachment="more")
    wait_cache(pair[0])
    (reply,) = pair[0].node().get(f"{key}/@adv/**", accept_replies=ANY, timeout=10.0)
    assert reply.ok.source_info is None
    assert reply.ok.attachment.to_string() == "more"
    publisher.undeclare()


def heard_before(pair, recovery, *, stamps):
    """A publisher at one robot and a subscriber that recovers at the other, which has heard a sample with a number."""
    app = pair[1].node(stamps=stamps)
    publisher = publisher_of(app, "covered/a")
    recovered = Recovered(pair[0], "covered/a", recovery)
    wait_interest(pair[0], pair[1], keys=("covered/a",))
    wait_matching(app, "covered/a")
    wait_cache(pair[0])
    publisher.put("before")
    wait_until(lambda: recovered.heard, what="a sample with a number")
    return publisher, recovered


@pytest.mark.parametrize("stamps", [False, True], ids=["numbers", "numbers and stamps"])
@pytest.mark.parametrize("recovery", [HEARTBEAT, PERIODIC], ids=["heartbeat", "periodic queries"])
def test_what_is_dropped_on_purpose_is_not_fetched(pair, stamps, recovery):
    """A subscriber that recovers hears what the decisions forwarded, and misses nothing; also when it knew numbers."""
    for robot in pair:
        robot.switch(Mode.PASS)
    publisher, recovered = heard_before(pair, recovery, stamps=stamps)
    pair[1].switch(Mode.ENFORCE)
    for i in range(6):
        publisher.put(str(i))
    wait_until(lambda: len(pair[1].asked) == 6, what="the samples to be asked for")
    for event in pair[1].asked:
        (pair[1].bridge.forward if event.sample % 2 else pair[1].bridge.payloads.drop)(event.sample)
    wait_until(lambda: len(recovered.heard) >= 4, what="every other one, but the last")
    wait_periods(pair, recovery, "dropped:heartbeat")
    assert recovered.heard == ["befor", "0", "2", "4"]
    assert not recovered.missed
    recovered.close()
    publisher.undeclare()


@pytest.mark.parametrize("stamps", [False, True], ids=["numbers", "numbers and stamps"])
@pytest.mark.parametrize("recovery", [HEARTBEAT, PERIODIC], ids=["heartbeat", "periodic queries"])
def test_what_was_sent_and_dropped_is_not_fetched_when_nothing_is_dropped_any_more(pair, stamps, recovery):
    """A subscriber that knew numbers from before hears what comes then, and nothing of the time between."""
    pair[1].switch(Mode.PASS)
    publisher, recovered = heard_before(pair, recovery, stamps=stamps)
    pair[1].switch(Mode.ENFORCE)
    for text in ("sent", "lost"):
        publisher.put(text)
    wait_until(lambda: len(pair[1].asked) == 2, what="the samples to be asked for")
    sent, dropped = pair[1].asked
    pair[1].bridge.forward(sent.sample)
    pair[1].bridge.payloads.drop(dropped.sample)
    wait_until(lambda: len(recovered.heard) == 2, what="what was sent")
    pair[1].switch(Mode.PASS)
    publisher.put("after")
    wait_until(lambda: "after" in recovered.heard, what="the next one")
    wait_periods(pair, recovery, "dropped:heartbeat")
    assert recovered.heard == ["befor", "sent", "after"]
    assert not recovered.missed
    recovered.close()
    publisher.undeclare()


def test_replies_for_covered_keys_go_by_their_stamps_alone(pair):
    """Without its number a reply is known by its stamp; one that has none would be heard twice, and stays."""
    stamped = publisher_of(pair[1].node(stamps=True), "covered/stamped")
    numbered = publisher_of(pair[1].node(), "covered/numbered")
    bypassing = publisher_of(pair[1].node(), "free/numbered")
    for publisher in (stamped, numbered, bypassing):
        publisher.put("x")
    wait_until(lambda: len(pair[0].bridge.describe()["queryables"]["outward"]) == 3, what="the mirrored caches")
    fence_apps(pair[0])
    replies = list(pair[0].node().get("*/*/@adv/**", accept_replies=ANY, consolidation=NONE, timeout=10.0))
    found = {str(reply.ok.key_expr): reply.ok.source_info is not None for reply in replies}
    assert found == {"covered/stamped": False, "free/numbered": True}
    for publisher in (stamped, numbered, bypassing):
        publisher.undeclare()


@pytest.mark.parametrize("mode", [Mode.PASS, Mode.SHADOW])
def test_where_nothing_is_dropped_covered_samples_keep_their_numbers(pair, mode):
    """Live, in replies and in heartbeats."""
    pair[1].switch(mode)
    assert pair[1].bridge._courses.numbered("covered/a")
    pair[1].switch(Mode.ENFORCE)
    assert not pair[1].bridge._courses.numbered("covered/a")
    assert pair[1].bridge._courses.numbered("free/a")


def test_when_replies_cannot_have_numbers_nothing_has(stack, tmp_path):
    """Live samples without, no heartbeats, in either direction: nobody fetches what could not be told apart."""
    pair = robots.team(stack, tmp_path, size=2, rules=({}, {}), **SMALL_PIECES)
    for there, here in (pair, pair[::-1]):
        key = f"free/{there.mesh.zid()}"
        app = there.node()
        publisher = publisher_of(app, key)
        heard, beats = Heard(here.node(), key), Heard(here.node(), f"{key}/@adv/**")
        wait_interest(here, there, keys=(key, f"{key}/@adv/**"))
        wait_matching(app, key)
        publisher.put("x")
        wait_until(lambda heard=heard: heard.samples, what="the sample")
        wait_until(lambda there=there: passed(there, "dropped:heartbeat") > 2, what="heartbeats")
        fence(here, there)
        wait_cache(here)
        assert heard.samples[0].source_info is None
        assert not beats.samples
        assert not list(here.node().get(f"{key}/@adv/**", accept_replies=ANY, timeout=10.0))
        publisher.undeclare()
