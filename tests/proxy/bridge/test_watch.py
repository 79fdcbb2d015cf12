"""What is declared on one side exists on the other, for as long as it does."""

import zenoh
import zenoh.ext

from proxy.core.events import InterestChanged, MatchingChanged, SamplesPassed
from tests.proxy.bridge.robots import wait_interest
from tests.proxy.nodes import Heard
from tests.waiting import wait_until


def tokens(app):
    # The declaring app itself hears of its token twice: from itself and from its router.
    return {str(reply.ok.key_expr) for reply in app.liveliness().get("alive/**", timeout=5.0) if reply.ok}


def test_tokens_are_mirrored_and_vanish(team):
    """A token of an app is seen on all robots, once, and is gone everywhere when the app takes it back."""
    apps = [robot.node() for robot in team]
    token = apps[0].liveliness().declare_token("alive/a")
    same = apps[1].liveliness().declare_token("alive/same")
    kept = apps[2].liveliness().declare_token("alive/same")
    wait_until(lambda: all(tokens(app) == {"alive/a", "alive/same"} for app in apps), what="the tokens on all robots")
    token.undeclare()
    wait_until(lambda: all(tokens(app) == {"alive/same"} for app in apps), what="the token to vanish")
    same.undeclare()
    wait_until(lambda: not team[1].bridge._watch._tokens_out.expressions, what="one of two equal tokens to vanish")
    wait_until(lambda: all(tokens(app) == {"alive/same"} for app in apps), what="the other one everywhere")
    kept.undeclare()
    wait_until(lambda: not any(tokens(app) for app in apps), what="the last token to vanish")


def test_tokens_of_a_vanished_app_do_not_keep_each_other_alive(pair):
    """Mirrors of mirrors are not mirrored: when the app is gone, so is its token, on both robots."""
    app = pair[0].node()
    kept = app.liveliness().declare_token("alive/b")
    other = pair[1].node()
    wait_until(lambda: tokens(other) == {"alive/b"}, what="the token on the other robot")
    assert not pair[0].bridge._watch._tokens_in.expressions
    app.close()
    wait_until(lambda: not tokens(other), what="the token to vanish")
    assert not tokens(pair[0].node())
    del kept


def test_a_liveliness_subscriber_learns_of_remote_tokens(pair):
    """Declaring and dropping a token is told to subscribers of other robots' apps."""
    told = []
    subscriber = pair[1].node().liveliness().declare_subscriber("alive/*", lambda s: told.append(s.kind))
    token = pair[0].node().liveliness().declare_token("alive/c")
    wait_until(lambda: len(told) == 1, what="the token")
    token.undeclare()
    wait_until(lambda: len(told) == 2, what="its end")
    assert told == [zenoh.SampleKind.PUT, zenoh.SampleKind.DELETE]
    subscriber.undeclare()


def test_the_core_learns_what_the_apps_subscribe_to(pair):
    """Every change of the apps' subscriptions is told whole; our own and mirrored ones are not among them."""
    app = pair[0].node()
    first, _ = Heard(app, "interest/a"), Heard(app, "interest/**")
    Heard(pair[1].node(), "elsewhere")
    expected = ("interest/**", "interest/a")
    wait_until(
        lambda: pair[0].posted(InterestChanged) and pair[0].posted(InterestChanged)[-1].keys == expected,
        what="both subscriptions",
    )
    first.subscriber.undeclare()
    wait_until(lambda: pair[0].posted(InterestChanged)[-1].keys == ("interest/**",), what="one of them")


def test_verbatim_keys_of_advanced_pubsub_and_ros_cross(pair):
    """`@adv` and `@ros2_lv` chunks, which `**` does not match, are bridged all the same."""
    keys = ("topic/@adv/pub/x", "@ros2_lv/0/node")
    app = pair[1].node()
    heard = [Heard(app, key) for key in keys]
    wait_interest(pair[1], pair[0], keys=keys)
    other = pair[0].node()
    for key in keys:
        other.put(key, key)
    wait_until(lambda: all(h.samples for h in heard), what="both samples")
    assert [h.payloads for h in heard] == [[key] for key in keys]


def test_verbatim_tokens_cross(pair):
    """Tokens of ROS 2 are found on the other robot while they exist."""
    token = pair[1].node().liveliness().declare_token("@ros2_lv/0/node")
    other = pair[0].node()

    def seen():
        return [str(r.ok.key_expr) for r in other.liveliness().get("@ros2_lv/**", timeout=5.0) if r.ok]

    wait_until(lambda: seen() == ["@ros2_lv/0/node"], what="the token")
    token.undeclare()
    wait_until(lambda: not seen(), what="its end")


def test_an_advanced_subscriber_gets_the_history_of_a_remote_publisher(pair):
    """A late joiner asks the other robot's cache, and hears what is published then, each sample once."""
    publisher = zenoh.ext.declare_advanced_publisher(
        pair[1].node(stamps=True),
        "topic/a",
        cache=zenoh.ext.CacheConfig(max_samples=3),
        publisher_detection=True,
    )
    for i in range(5):
        publisher.put(str(i))
    wait_until(lambda: sum(e.count for e in pair[1].posted(SamplesPassed)) == 5, what="all to have left")
    heard = []
    subscriber = zenoh.ext.declare_advanced_subscriber(
        pair[0].node(),
        "topic/a",
        lambda sample: heard.append(sample.payload.to_string()),
        history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
    )
    wait_until(lambda: len(heard) == 3, what="the history")
    wait_interest(pair[0], pair[1], keys=("topic/a",))
    publisher.put("5")
    wait_until(lambda: "5" in heard, what="a new sample")
    assert heard == ["2", "3", "4", "5"]
    subscriber.undeclare()
    publisher.undeclare()


def test_what_was_dropped_is_not_fetched_from_the_cache(pair):
    """A subscriber that recovers what it misses hears what the decisions forwarded, once and in order, and no more."""
    publisher = zenoh.ext.declare_advanced_publisher(
        pair[1].node(stamps=True),
        "covered/a",
        cache=zenoh.ext.CacheConfig(max_samples=10),
        sample_miss_detection=zenoh.ext.MissDetectionConfig(heartbeat=0.05, sporadic_heartbeat=None),
        publisher_detection=True,
    )
    heard = []
    subscriber = zenoh.ext.declare_advanced_subscriber(
        pair[0].node(),
        "covered/a",
        lambda sample: heard.append(sample.payload.to_string()),
        history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
        recovery=zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
    )
    wait_interest(pair[0], pair[1], keys=("covered/a",))
    for i in range(6):
        publisher.put(str(i))
    wait_until(lambda: len(pair[1].asked) == 6, what="the samples to be asked for")
    for event in pair[1].asked:
        (pair[1].bridge.drop if event.sample % 2 else pair[1].bridge.forward)(event.sample)

    def beats():
        return sum(event.count for event in pair[1].posted(SamplesPassed) if event.reason == "dropped:heartbeat")

    wait_until(lambda: len(heard) == 3 and beats() > 3, what="every other one, and heartbeats")
    assert heard == ["1", "3", "5"]
    subscriber.undeclare()
    publisher.undeclare()


def test_the_core_learns_when_somebody_begins_and_ceases_to_want_a_key(pair):
    """Matching of a covered key is told with its first sample and with every change."""
    publisher = pair[0].node()
    publisher.put("covered/m", "x")
    wait_until(lambda: pair[0].posted(MatchingChanged), what="the first answer")
    remote = Heard(pair[1].node(), "covered/*")
    wait_until(lambda: len(pair[0].posted(MatchingChanged)) == 2, what="a subscriber")
    remote.subscriber.undeclare()
    wait_until(lambda: len(pair[0].posted(MatchingChanged)) == 3, what="its end")
    assert [(event.key, event.matching) for event in pair[0].posted(MatchingChanged)] == [
        ("covered/m", False),
        ("covered/m", True),
        ("covered/m", False),
    ]


def test_when_declarations_cannot_be_followed_everything_crosses(pair):
    """Should a future Zenoh speak differently, apps still hear the mesh: by subscribing to all of it."""
    pair[0].bridge._watch._apps.ledger.broken = True
    wait_interest(pair[0], pair[1], keys=("**", "**/@adv/**", "@ros2_lv/**"))
    heard = Heard(pair[0].node(), "free/a")
    pair[1].node().put("free/a", "x")
    wait_until(lambda: heard.samples, what="the sample")
    assert heard.payloads == ["x"]
