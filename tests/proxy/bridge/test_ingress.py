"""What enters on the app side; who hears what is in test_bridge."""

from dataclasses import replace

import pytest
import zenoh

from proxy.bridge import courses, payloads
from proxy.bridge.egress import Egress
from proxy.bridge.passed import TOO_LARGE
from proxy.bridge.room import Room
from proxy.bridge.sessions import largest_payload
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import SamplesPassed
from proxy.core.model.mode import Mode
from tests.proxy.bridge.robots import fence_apps, team, wait_interest
from tests.proxy.nodes import Heard, wait_matching
from tests.waiting import wait_until
from utility_specs import Specs


@pytest.fixture
def wanted(pair):
    """Everything is wanted by an app of the other robot."""
    heard = Heard(pair[1].node(), "**")
    wait_interest(pair[1], pair[0], keys=("**",))
    return heard


@pytest.mark.usefixtures("wanted")
def test_no_more_is_held_than_the_bound(pair, monkeypatch):
    """When the core does not answer, samples beyond the bound are dropped, counted, and local apps still hear all."""
    monkeypatch.setattr(pair[0].bridge.rooms.covered, "most", 3)
    local = Heard(pair[0].node(), "covered/**")
    wait_interest(pair[0], keys=("covered/**",))
    publisher = pair[0].node()
    for i in range(5):
        publisher.put("covered/a", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: len(local.samples) == 5, what="local delivery")
    wait_until(lambda: sum(event.count for event in pair[0].posted(SamplesPassed)) == 2, what="the counts")
    assert len(pair[0].asked) == pair[0].bridge.describe()["held"] == 3
    assert {event.reason for event in pair[0].posted(SamplesPassed)} == {"dropped:overflow"}
    for asked in pair[0].asked:
        pair[0].bridge.payloads.drop(asked.sample)
    assert pair[0].bridge.describe()["queue"]["covered"] == {"samples": 0, "bytes": 0}


@pytest.mark.usefixtures("wanted")
@pytest.mark.parametrize("waits", [True, False])
def test_where_many_are_held_only_who_would_rather_wait_lingers(pair, monkeypatch, waits):
    """A moment for each sample, so that the core catches up."""
    lingered = []
    monkeypatch.setattr(Room, "linger", lambda _, size: lingered.append(size))
    monkeypatch.setattr(pair[0].bridge.rooms.covered, "most", 4)
    control = zenoh.CongestionControl.BLOCK if waits else zenoh.CongestionControl.DROP
    publisher = pair[0].node()
    for _ in range(4):
        publisher.put("covered/a", "x", congestion_control=control)
    wait_until(lambda: len(pair[0].asked) == 4, what="the samples")
    assert lingered == [1] * waits


@pytest.mark.usefixtures("wanted")
def test_for_a_mesh_that_stands_still_nobody_lingers(pair, monkeypatch):
    """Local applications go on at full speed."""
    lingered = []
    monkeypatch.setattr(Room, "linger", lambda _, size: lingered.append(size))
    monkeypatch.setattr(Egress, "stands", True)
    monkeypatch.setattr(pair[0].bridge.rooms.covered, "most", 2)
    publisher = pair[0].node()
    for _ in range(3):
        publisher.put("covered/a", "x", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: pair[0].posted(SamplesPassed), what="the count of the third")
    assert not lingered


@pytest.mark.usefixtures("wanted")
def test_no_more_bytes_are_held_than_the_bound(pair, monkeypatch):
    """Two samples are held whatever their size, and what is released makes room."""
    monkeypatch.setattr(pair[0].bridge.rooms.covered, "most_bytes", 100)
    publisher = pair[0].node()
    for i in range(3):
        publisher.put(f"covered/{i}", "x" * 101, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: pair[0].posted(SamplesPassed), what="the count")
    first, _ = pair[0].asked
    pair[0].bridge.payloads.drop(first.sample)
    publisher.put("covered/3", "x" * 101)
    wait_until(lambda: len(pair[0].asked) == 3, what="the next one")
    assert pair[0].bridge.describe()["held"] == 2


@pytest.mark.usefixtures("wanted")
def test_what_is_held_can_be_looked_at(pair):
    """It stays held until it is decided."""
    pair[0].node().put("covered/a", "x")
    wait_until(lambda: pair[0].asked, what="the sample")
    number = pair[0].asked[0].sample
    held = pair[0].bridge.payloads.waiting(number)
    assert (held.key, held.sample.payload.to_string()) == ("covered/a", "x")
    pair[0].bridge.payloads.drop(number)
    assert pair[0].bridge.payloads.waiting(number) is None


@pytest.mark.usefixtures("wanted")
def test_what_features_are_taken_of_is_what_is_held(pair, monkeypatch):
    """Where many wait in memory of their own, that is all that waits for an extractor, too."""
    monkeypatch.setattr(payloads, "TUNING", replace(TUNING, few_held=0))
    pair[0].node().put("covered/a", "x")
    wait_until(lambda: pair[0].asked, what="the sample")
    assert pair[0].payloads[0] is pair[0].bridge.payloads.waiting(pair[0].asked[0].sample).sample.payload


@pytest.mark.usefixtures("wanted")
def test_a_delete_of_a_covered_key_is_marked(pair):
    """The core is told that it is a delete."""
    pair[0].node().delete("covered/a")
    wait_until(lambda: pair[0].asked, what="the delete")
    assert pair[0].asked[0].delete


@pytest.mark.usefixtures("wanted")
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


def test_heartbeats_of_publishers_without_numbers_stay(pair):
    """Where a spec covers a key its numbers do not cross, so nobody could make use of them; other heartbeats cross."""
    remote = Heard(pair[1].node(), "**/@adv/**")
    wait_interest(pair[1], pair[0], keys=("**/@adv/**",))
    for app in (pair[0].node(stamps=True), pair[0].node()):
        app.put(f"covered/a/@adv/pub/{app.zid()}/1/_", "heartbeat")
        app.put(f"a/@adv/pub/{app.zid()}/1/_", "of use")
    wait_until(lambda: len(remote.samples) == 2, what="those of use")
    wait_until(lambda: sum(event.count for event in pair[0].posted(SamplesPassed)) == 4, what="the counts")
    assert remote.payloads == ["of use"] * 2
    assert {event.reason for event in pair[0].posted(SamplesPassed)} == {"dropped:heartbeat", "passed:no-spec"}


@pytest.mark.usefixtures("wanted")
def test_peers_on_the_app_side_are_heard_once(pair):
    """Peer-mode apps of one robot hear each other directly, and the daemon hears each sample once."""
    subscriber, publisher = pair[0].node("peer"), pair[0].node("peer")
    local = Heard(subscriber, "covered/**")
    wait_until(lambda: "covered/**" in pair[0].bridge.describe()["subscriptions"], what="the subscription")
    # The daemon matches what is covered, too; what begins with @ only the other app does, which declares it later.
    last = Heard(subscriber, "@last")
    wait_until(publisher.info.peers_zid, what="the link of the apps")
    wait_matching(publisher, "@last")
    publisher.put("covered/a", "x")
    wait_until(lambda: local.samples and pair[0].asked, what="the sample")
    publisher.put("covered/end", "x")
    wait_until(lambda: "covered/end" in [event.key for event in pair[0].asked], what="the last sample")
    assert [event.key for event in pair[0].asked] == ["covered/a", "covered/end"]
    assert not last.samples


def test_what_nobody_wants_is_not_even_received(pair):
    """Only what somebody on the mesh subscribes to is taken from the apps; the rest costs nothing."""
    remote = Heard(pair[1].node(), "covered/wanted")
    wait_interest(pair[1], pair[0], keys=("covered/wanted",))
    app = pair[0].node()
    app.put("covered/unwanted", "x")
    app.put("covered/wanted", "x")
    wait_until(lambda: pair[0].asked, what="the wanted sample")
    assert [event.key for event in pair[0].asked] == ["covered/wanted"]
    assert pair[0].bridge.describe()["observed"] == ["covered/wanted"]
    remote.subscriber.undeclare()
    wait_until(lambda: not pair[0].bridge.describe()["observed"], what="nobody to want anything")


def test_overlapping_wishes_make_one_question(pair):
    """Whatever overlaps on the other robot, a sample is taken once, also while subscriptions come and go."""
    heard = Heard(pair[1].node(), "covered/*/x")
    other = Heard(pair[1].node(), "*/a/x")
    wait_interest(pair[1], pair[0], keys=("covered/*/x", "*/a/x"))
    app = pair[0].node()
    for i in range(200):
        app.put("covered/a/x", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
        if i == 50:
            heard.subscriber.undeclare()
        if i == 100:
            wait_until(lambda: pair[0].bridge.describe()["observed"] == ["*/a/x"], what="the end of one")
            heard = Heard(pair[1].node(), "covered/*/x")
    wait_until(lambda: len(pair[0].asked) >= 200, what="all samples")
    assert len(pair[0].asked) == 200
    del other


@pytest.mark.usefixtures("wanted")
def test_what_left_for_the_mesh_and_came_back_around_the_daemons_stays(pair):
    """It is counted, and does not go round. What an application publishes with a stamp of ours is none of these."""
    publisher, elsewhere = pair[0].node(), Heard(pair[1].node(), "free/a")
    wait_until(lambda: publisher.put("free/a", "gone") or elsewhere.samples, what="one that left")
    stamp = elsewhere.samples[0].timestamp
    publisher.put("free/a", "back", timestamp=stamp)
    publisher.put("covered/a", "answer", timestamp=stamp)
    publisher.put("covered/a", "answer", timestamp=stamp)
    publisher.put("covered/b", "new")
    wait_until(lambda: len(pair[0].asked) == 2, what="the new one")
    assert [sample.key for sample in pair[0].asked] == ["covered/a", "covered/b"]
    assert pair[0].bridge.describe()["returned"] == 2


def test_what_others_could_not_put_together_stays_and_is_counted(stack, tmp_path):
    """A message may be as large as Zenoh is told: by default 64 MB, so that a stranger's does not take all memory."""
    largest = {"transport": {"link": {"rx": {"max_message_size": TUNING.around_payload + 50_000}}}}
    pair = team(stack, tmp_path, size=2, zenoh=largest)
    heard = Heard(pair[1].node(), "free/**")
    wait_interest(pair[1], pair[0], keys=("free/**",))
    app, block = pair[0].node(), zenoh.CongestionControl.BLOCK
    for size in (50_001, 50_000):
        app.put("free/a", bytes(size), congestion_control=block)
    wait_until(lambda: heard.samples, what="the one that can cross")
    assert [len(sample.payload) for sample in heard.samples] == [50_000]
    wait_until(lambda: any(each.reason == TOO_LARGE for each in pair[0].posted(SamplesPassed)), what="the count")
    assert largest_payload({}) == TUNING.largest_message - TUNING.around_payload


OWN_RULES = """
version = 1
[[information_type]]
name = "urgent"
keys = ["urgent/**"]
bypass = true
queries = "drop"
utility = { kind = "video" }
[[information_type]]
name = "plain"
keys = ["plain/**"]
mode = "pass"
utility = { kind = "video" }
[[information_type]]
name = "rest"
keys = ["**"]
utility = { kind = "video" }
"""


def test_types_that_are_not_planned_go_at_once_and_are_counted(stack, tmp_path):
    """Only the rest is asked for; queries for keys of which a spec drops them are not answered."""
    near, far = team(stack, tmp_path, size=2, specs=OWN_RULES)
    heard = Heard(far.node(), "*/a")
    wait_interest(far, near, keys=("*/a",))
    app = near.node()
    for name in ("urgent", "plain", "rest"):
        app.put(f"{name}/a", name)
    wait_until(lambda: len(heard.samples) == 2 and near.asked, what="what passes, and what is asked")
    assert sorted(heard.payloads) == ["plain", "urgent"]
    assert [event.key for event in near.asked] == ["rest/a"]
    wait_until(lambda: len(near.posted(SamplesPassed)) >= 2, what="the counts")
    assert {event.reason for event in near.posted(SamplesPassed)} == {"passed:bypass", "passed:mode"}
    for name in ("urgent", "plain"):
        app.declare_queryable(f"{name}/q", lambda query: query.reply(query.key_expr, b"here"))
    wait_until(lambda: len(far.bridge.describe()["queryables"]["outward"]) == 2, what="the queryables")
    fence_apps(far)
    asker = far.node()
    assert [len(list(asker.get(f"{name}/q", timeout=5.0))) for name in ("plain", "urgent")] == [1, 0]
    assert far.bridge.describe()["denied"]["in"]["queries"] == 1


def test_what_becomes_of_a_key_is_worked_out_anew_when_the_mode_changes(pair, wanted, monkeypatch):
    """And when more keys come in between than are remembered."""
    monkeypatch.setattr(courses, "BOUNDS", replace(courses.BOUNDS, keys=1))
    publisher = pair[0].node()

    def heard():
        return [str(sample.key_expr) for sample in wanted.samples]

    asked = []
    for done, mode in enumerate((Mode.ENFORCE, Mode.PASS, Mode.ENFORCE), 1):
        pair[0].switch(mode)
        for key in ("covered/a", "free/a"):
            publisher.put(key, "x", congestion_control=zenoh.CongestionControl.BLOCK)
        wait_until(lambda done=done: heard().count("free/a") == done, what="both samples")
        asked.append(len(pair[0].asked))
        for each in pair[0].asked:
            pair[0].bridge.payloads.drop(each.sample)
    assert asked == [1, 1, 2]
    assert heard().count("covered/a") == 1


@pytest.mark.parametrize(
    "change",
    [lambda robot: robot.switch(Mode.PASS), lambda robot: robot.swap(Specs.empty())],
    ids=["in mode pass", "as specs cover it no more"],
)
def test_what_needs_no_decision_goes_behind_samples_of_its_key_that_wait(pair, wanted, change):
    """These were to be decided; other keys go at once, and so does that one once nothing of it waits."""
    app, block = pair[0].node(), {"congestion_control": zenoh.CongestionControl.BLOCK}
    app.put("covered/a", "first", **block)
    wait_until(lambda: pair[0].asked, what="the first one")
    change(pair[0])
    app.put("covered/a", "second", **block)
    app.put("covered/b", "other", **block)
    wait_until(lambda: wanted.payloads == ["other"], what="the one of another key")
    wait_until(lambda: len(pair[0].asked) == 2, what="the second one")
    for asked in pair[0].asked:
        pair[0].bridge.forward(asked.sample)
    wait_until(lambda: wanted.payloads == ["other", "first", "second"], what="both")
    app.put("covered/a", "third", **block)
    wait_until(lambda: wanted.payloads[-1] == "third", what="the next one, at once")
    assert len(pair[0].asked) == 2


@pytest.mark.usefixtures("wanted")
def test_a_sample_waits_until_the_mesh_session_has_it(pair, monkeypatch):
    """What passes meanwhile, on another thread, would overtake it."""
    bridge, waits = pair[0].bridge, []
    forward = bridge._egress.forward

    def watched(number, held):
        waits.append(bridge.payloads.holds(held.key))
        forward(number, held)
        waits.append(bridge.payloads.holds(held.key))

    monkeypatch.setattr(bridge._egress, "forward", watched)
    pair[0].node().put("covered/a", "x", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: pair[0].asked, what="the sample")
    bridge.forward(pair[0].asked[0].sample)
    assert waits == [True, True]
    assert not bridge.payloads.holds("covered/a")


def test_what_is_subscribed_to_stays_while_something_wider_comes_and_goes(pair):
    """Zenoh loses samples when one of two subscriptions that match them goes, so none goes that is wanted still."""
    stays = Heard(pair[1].node(), "free/a")
    wait_interest(pair[1], pair[0], keys=("free/a",))
    wait_until(lambda: pair[0].bridge.describe()["observed"] == ["free/a"], what="the first")
    wider = Heard(pair[1].node(), "free/**")
    wait_until(lambda: len(pair[0].bridge.describe()["observed"]) > 1, what="the wider one")
    beside = Heard(pair[1].node(), "free/b")
    other = Heard(pair[1].node(), "other")
    wait_until(lambda: "other" in pair[0].bridge.describe()["observed"], what="one more")
    wait_until(lambda: not pair[0].bridge._ingress.leaving, what="the end of what is to go")
    assert pair[0].bridge.describe()["observed"] == ["free/**", "free/a", "other"]
    for heard in (wider, other, beside):
        heard.subscriber.undeclare()
    wait_until(lambda: pair[0].bridge.describe()["observed"] == ["free/a"], what="the end of the others")
    pair[0].node().put("free/a", "x")
    wait_until(lambda: stays.payloads == ["x"], what="the sample")
