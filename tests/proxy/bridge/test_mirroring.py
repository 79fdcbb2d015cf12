"""What is declared on one side exists on the other, for as long as it does."""

import itertools
import threading
from dataclasses import replace

import pytest
import zenoh
import zenoh.ext

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.keys import INGRESS
from proxy.core.interface.events import InterestChanged, MatchingChanged, SamplesPassed
from tests.proxy.bridge.declarations.test_wire import frame
from tests.proxy.bridge.robots import fence, observes, wait_interest
from tests.proxy.nodes import Heard, answers, closing, pass_fence, plain_session, wait_matching
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
    wait_until(lambda: not team[1].bridge._mirroring._tokens_out.expressions, what="one of two equal tokens to vanish")
    wait_until(lambda: all(tokens(app) == {"alive/same"} for app in apps), what="the other one everywhere")
    kept.undeclare()
    wait_until(lambda: not any(tokens(app) for app in apps), what="the last token to vanish")


def test_tokens_of_a_vanished_app_do_not_keep_each_other_alive(pair):
    """Mirrors of mirrors are not mirrored: when the app is gone, so is its token, on both robots."""
    app = pair[0].node()
    kept = app.liveliness().declare_token("alive/b")
    other = pair[1].node()
    wait_until(lambda: tokens(other) == {"alive/b"}, what="the token on the other robot")
    assert not pair[0].bridge._mirroring._tokens_in.expressions
    app.close()
    wait_until(lambda: not tokens(other), what="the token to vanish")
    assert not tokens(pair[0].node())
    del kept


def test_a_liveliness_subscriber_learns_of_remote_tokens(pair):
    """Declaring and dropping a token is told to subscribers of other robots' apps."""
    told, app = [], pair[1].node()
    subscriber = app.liveliness().declare_subscriber("alive/*", lambda s: told.append(s.kind))
    pass_fence(app, pair[1].app)
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
    app = pair[1].node(stamps=True)
    publisher = zenoh.ext.declare_advanced_publisher(
        app,
        "topic/a",
        cache=zenoh.ext.CacheConfig(max_samples=3),
        publisher_detection=True,
    )
    for i in range(5):
        publisher.put(str(i))
    wait_until(lambda: pair[0].bridge.describe()["queryables"]["outward"], what="the mirrored cache")
    heard = []
    subscriber = zenoh.ext.declare_advanced_subscriber(
        pair[0].node(),
        "topic/a",
        lambda sample: heard.append(sample.payload.to_string()),
        history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
    )
    wait_until(lambda: len(heard) == 3, what="the history")
    wait_interest(pair[0], pair[1], keys=("topic/a",))
    wait_matching(app, "topic/a")
    publisher.put("5")
    wait_until(lambda: "5" in heard, what="a new sample")
    assert heard == ["2", "3", "4", "5"]
    subscriber.undeclare()
    publisher.undeclare()


def test_what_was_dropped_is_not_fetched_from_the_cache(pair):
    """A subscriber that recovers what it misses hears what the decisions forwarded, once and in order, and no more."""
    app = pair[1].node(stamps=True)
    publisher = zenoh.ext.declare_advanced_publisher(
        app,
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
        recovery=zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
    )
    wait_interest(pair[0], pair[1], keys=("covered/a",))
    wait_matching(app, "covered/a")
    for i in range(6):
        publisher.put(str(i))
    wait_until(lambda: len(pair[1].asked) == 6, what="the samples to be asked for")
    for event in pair[1].asked:
        (pair[1].bridge.payloads.drop if event.sample % 2 else pair[1].bridge.forward)(event.sample)

    def beats():
        return sum(event.count for event in pair[1].posted(SamplesPassed) if event.reason == "dropped:heartbeat")

    wait_until(lambda: len(heard) == 3 and beats() > 3, what="every other one, and heartbeats")
    assert heard == ["1", "3", "5"]
    subscriber.undeclare()
    publisher.undeclare()


def test_the_core_learns_when_somebody_begins_and_ceases_to_want_a_key(pair):
    """Matching of a covered key is told with its first sample and with every change."""
    publisher = pair[0].node()
    remote = Heard(pair[1].node(), "covered/*")
    wait_interest(pair[1], pair[0], keys=("covered/*",))
    publisher.put("covered/m", "x")
    wait_until(lambda: len(pair[0].posted(MatchingChanged)) == 1, what="the first answer")
    remote.subscriber.undeclare()
    wait_until(lambda: len(pair[0].posted(MatchingChanged)) == 2, what="the subscriber's end")
    Heard(pair[1].node(), "covered/*")
    wait_until(lambda: len(pair[0].posted(MatchingChanged)) == 3, what="another subscriber")
    assert [(event.key, event.matching) for event in pair[0].posted(MatchingChanged)] == [
        ("covered/m", True),
        ("covered/m", False),
        ("covered/m", True),
    ]


@pytest.mark.parametrize("expression", ["**/*", "**"])
def test_an_app_that_wants_everything_hears_the_other_robot_however_it_says_so(pair, expression):
    """`**/*` is `*/**` to Zenoh, as our own subscriptions are where declarations cannot be followed."""
    heard = Heard(pair[1].node(), zenoh.KeyExpr.autocanonize(expression))
    app = pair[0].node()
    wait_matching(app, "free/a")
    app.put("free/a", "x", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: heard.payloads == ["x"], what="the sample")


def break_wire(declarations):
    """Let it read what no Zenoh of today writes."""
    declarations._table.read(frame(b"\x0a"), inward=True)
    assert declarations._table.broken


def test_when_declarations_cannot_be_followed_everything_crosses(pair):
    """Should a future Zenoh speak differently, apps still hear the mesh: by subscribing to all of it."""
    assert pair[0].bridge.warnings() == []
    break_wire(pair[0].bridge._mirroring._apps)
    (warning,) = pair[0].bridge.warnings()
    assert warning.startswith("what applications declare cannot be followed")
    wait_interest(pair[0], pair[1], keys=("**", "**/@adv/**", "@ros2_lv/**"))
    app = pair[0].node()
    heard = Heard(app, "free/a")
    pass_fence(app, pair[0].app)
    pair[1].node().put("free/a", "x")
    wait_until(lambda: heard.samples, what="the sample")
    assert heard.payloads == ["x"]


def test_when_the_mesh_cannot_be_followed_everything_is_offered_to_it(pair):
    """What remote apps want is then not known: all is taken from the apps, and reaches who subscribes."""
    break_wire(pair[0].bridge._mirroring._others)
    wait_until(lambda: pair[0].bridge.describe()["observed"] == sorted(INGRESS), what="the blanket")
    heard = Heard(pair[1].node(), "free/a")
    wait_until(lambda: "free/a" in pair[1].bridge.describe()["subscriptions"], what="the subscription")
    fence(pair[1], pair[0])
    pair[0].node().put("free/a", "x")
    wait_until(lambda: heard.samples, what="the sample")
    assert heard.payloads == ["x"]


def declares_nothing_but_own(robot):
    """Whether nothing is mirrored in any direction."""
    told = robot.bridge.describe()
    return not (told["subscriptions"] or told["observed"] or any(told["queryables"].values()))


@pytest.mark.parametrize("expression", ["m/a", "m/*", "**", "m/$*b", "@x/a", "m/@y/**"])
def test_a_publisher_matches_exactly_while_a_remote_subscriber_exists(pair, expression):
    """Matching of an app's publisher is true while an app of the other robot subscribes, and false after."""
    key = expression.replace("$*", "x").replace("**", "a").replace("*", "a")
    publisher = pair[0].node().declare_publisher(key)
    told = []
    publisher.declare_matching_listener(lambda status: told.append(status.matching))
    assert not publisher.matching_status.matching
    for _ in range(3):
        remote = Heard(pair[1].node(), expression)
        wait_until(lambda: told[-1:] == [True], what="the subscriber")
        remote.subscriber.undeclare()
        wait_until(lambda: told[-1:] == [False], what="its end")
    assert told == [True, False] * 3
    wait_until(lambda: all(map(declares_nothing_but_own, pair)), what="nothing to be left")


def test_robots_that_want_the_same_do_not_keep_it_wanted(team):
    """Equal and overlapping subscriptions on three robots: each is mirrored for exactly as long as somebody has it."""
    apps = [robot.node() for robot in team]
    publishers = [app.declare_publisher("same/a") for app in (robot.node() for robot in team)]
    heard = {(n, key): Heard(app, key) for n, app in enumerate(apps) for key in ("same/a", "same/*", "**")}

    def matching():
        return [publisher.matching_status.matching for publisher in publishers]

    wait_until(lambda: matching() == [True] * 3, what="all to match")
    for n, key in list(heard):
        if n != 1 or key != "same/*":
            heard.pop((n, key)).subscriber.undeclare()
    wait_until(lambda: team[1].bridge.describe()["subscriptions"] == ["same/*"], what="the last subscription")
    wait_until(lambda: not team[1].bridge.describe()["observed"], what="nobody else to want anything")
    for n in (0, 2):
        wait_until(lambda n=n: team[n].bridge.describe()["observed"] == ["same/*"], what="the last wish")
        wait_until(lambda n=n: not team[n].bridge.describe()["subscriptions"], what="no wish of their own")
    assert matching() == [True] * 3
    heard.popitem()[1].subscriber.undeclare()
    wait_until(lambda: not any(matching()), what="nobody to match")
    wait_until(lambda: all(map(declares_nothing_but_own, team)), what="nothing to be left")


def test_a_querier_matches_exactly_while_a_remote_queryable_exists(pair):
    """Matching of queriers: of any queryable, or of a complete one where the target asks for that."""
    app = pair[0].node()
    anybody = app.declare_querier("serve/a")
    complete = app.declare_querier("serve/a", target=zenoh.QueryTarget.ALL_COMPLETE)

    def matching():
        return anybody.matching_status.matching, complete.matching_status.matching

    assert matching() == (False, False)
    other = pair[1].node()
    partly = other.declare_queryable("serve/*", lambda query: query.drop())
    wait_until(lambda: matching() == (True, False), what="an incomplete queryable")
    whole = other.declare_queryable("serve/*", lambda query: query.drop(), complete=True)
    wait_until(lambda: matching() == (True, True), what="a complete one")
    whole.undeclare()
    wait_until(lambda: matching() == (True, False), what="its end")
    partly.undeclare()
    wait_until(lambda: matching() == (False, False), what="the end of the last")


def test_any_verbatim_chunk_crosses(pair):
    """Samples, queries and tokens of keys that `**` does not match, in whatever chunk."""
    app, other = pair[0].node(), pair[1].node()
    heard = Heard(app, "@any/*")
    wait_interest(pair[0], pair[1], keys=("@any/*",))
    other.put("@any/a", "x")
    token = other.liveliness().declare_token("a/@some/t")
    served = other.declare_queryable("b/@other", lambda query: query.reply("b/@other", "y"))
    wait_until(lambda: heard.payloads == ["x"], what="the sample")
    wait_until(lambda: list(app.liveliness().get("**/@some/*", timeout=5.0)), what="the token")
    wait_until(lambda: list(answers(app, "b/@other")) == ["y"], what="the answer")
    token.undeclare()
    served.undeclare()


@pytest.mark.parametrize("local", [False, True], ids=["wanted there only", "wanted here too"])
def test_late_joiners_miss_nothing_and_hear_nothing_twice(pair, local):
    """History and live samples of a fast publisher join without a gap, for one late joiner after the other.

    Also when an app beside the publisher subscribes to the same. What is published meanwhile is bounded: Zenoh waits
    ten seconds for a history, and of what a busy machine needs longer for it loses the rest.
    """
    here = [Heard(pair[1].node(), "fast/a")] if local else []
    publisher = zenoh.ext.declare_advanced_publisher(
        pair[1].node(stamps=True),
        "fast/a",
        cache=zenoh.ext.CacheConfig(max_samples=100000),
        congestion_control=zenoh.CongestionControl.BLOCK,
    )
    stop, allowed = threading.Event(), threading.Semaphore(300)
    sent = itertools.count()

    def publish():
        while allowed.acquire() and not stop.wait(0.0005):
            publisher.put(str(next(sent)))

    thread = threading.Thread(target=publish)
    thread.start()
    wait_until(lambda: pair[0].bridge.describe()["queryables"]["outward"], what="the mirrored cache")
    joined = []
    for _ in range(6):
        allowed.release(300)
        joined.append(join(pair[0].node(), "fast/a"))
    stop.set()
    allowed.release()
    thread.join()
    last = next(sent)
    publisher.put(str(last))
    for _, heard in joined:
        wait_until(lambda heard=heard: heard[-1:] == [last], what="the last sample")
        assert runs(heard) == [(0, last)]
    for subscriber, _ in joined:
        subscriber.undeclare()
    publisher.undeclare()
    del here


def runs(numbers):
    """Return the first and the last of each run of consecutive numbers: a gap and a repetition begin a new one."""
    ends = [n for n in range(1, len(numbers)) if numbers[n] != numbers[n - 1] + 1]
    return [(numbers[first], numbers[end - 1]) for first, end in itertools.pairwise([0, *ends, len(numbers)])]


def join(app, key):
    """Subscribe with history, and wait until something came."""
    heard = []
    subscriber = zenoh.ext.declare_advanced_subscriber(
        app, key, lambda sample: heard.append(int(sample.payload.to_string())), history=zenoh.ext.HistoryConfig()
    )
    wait_until(lambda: heard, what="the history")
    return subscriber, heard


def test_tokens_of_a_robot_that_vanishes_vanish(pair):
    """When a whole daemon is gone, tokens of its apps are gone on the other robot, which says so."""
    told = []
    app = pair[0].node()
    app.liveliness().declare_subscriber("alive/*", lambda sample: told.append(str(sample.kind)), history=True)
    token = pair[1].node().liveliness().declare_token("alive/x")
    wait_until(lambda: told, what="the token")
    pair[1].mesh.close()
    wait_until(lambda: told[-1] == str(zenoh.SampleKind.DELETE), what="its end")
    assert not list(app.liveliness().get("alive/*", timeout=5.0))
    del token


@pytest.mark.full
def test_wishes_that_come_and_go_cost_a_standing_one_nothing(pair):
    """While wider and overlapping subscriptions come and go, the one that stays hears everything once, in order."""
    publisher = pair[0].node().declare_publisher("flow/a", congestion_control=zenoh.CongestionControl.BLOCK)
    stays, app = Heard(pair[1].node(), "flow/a"), pair[1].node()
    wait_interest(pair[1], pair[0], keys=("flow/a",))
    wait_until(lambda: publisher.matching_status.matching, what="the subscriber")
    stop = threading.Event()
    sent = itertools.count()

    def publish():
        while not stop.wait(0.0002):
            publisher.put(str(next(sent)))

    thread = threading.Thread(target=publish)
    thread.start()
    for expression in ("flow/*", "**", "*/a", "flow/**") * 3:
        passing = Heard(app, expression)
        wait_until(lambda e=expression: observes(pair[0], e), what="the wish")
        passing.subscriber.undeclare()
        wait_until(lambda: pair[0].bridge.describe()["observed"] == ["flow/a"], what="its end")
    stop.set()
    thread.join()
    total = next(sent)
    wait_until(lambda: len(stays.samples) >= total, what="all samples")
    assert stays.payloads == [str(i) for i in range(total)]


def test_a_look_that_fails_is_said_once_and_not_the_last(pair, caplog):
    """With a mesh session that is closed nothing can be declared there; the watch goes on, and says so only once."""
    wanted = Heard(pair[1].node(), "**")
    wait_interest(pair[1], pair[0], keys=("**",))
    app = pair[0].node()
    wait_until(lambda: app.put("free/a", "x") or wanted.samples, what="a sample")
    pair[0].mesh.close()
    # As a sample does that is taken just then; later ones are not, for nobody on the mesh wants them any more.
    pair[0].bridge.demand.note("free/b", wanted.samples[0], covered=False)
    wait_until(lambda: "cannot mirror" in caplog.text, what="the failure")
    token = app.liveliness().declare_token("alive/still")
    wait_until(lambda: "alive/still" in pair[0].bridge._mirroring._apps.declared("token"), what="the token")
    wait_until(lambda: "alive/still" in pair[0].bridge._mirroring._tokens_out.declared, what="another look")
    assert caplog.text.count("cannot mirror what was declared") == 1
    del token


def test_news_that_comes_as_a_wait_ends_is_not_forgotten(pair, monkeypatch):
    """Somebody declares just when the watch has waited in vain: it looks all the same."""
    news = pair[0].bridge._mirroring._wake
    wait, late = news.wait, []

    def ends_late(timeout):
        if wait(timeout):
            return True
        if not late:
            late.append(Heard(pair[1].node(), "late"))
            wait_until(news.is_set, what="the news")
        return False

    monkeypatch.setattr(news, "wait", ends_late)
    wait_until(lambda: observes(pair[0], "late"), what="the subscription")


def test_who_subscribes_without_end_keeps_nobody_from_what_apps_publish(pair, stack, monkeypatch):
    """Where there are too many subscribers everything is taken from the apps, until there are fewer."""
    monkeypatch.setattr("proxy.bridge.rules.BOUNDS", replace(BOUNDS, crossing={**BOUNDS.crossing, "subscribers": 3}))
    stranger = closing(stack, plain_session("peer", connect=(pair[0].mesh_endpoint,)))
    junk = [stranger.declare_subscriber(f"junk/{number}", lambda _: None) for number in range(4)]
    bridge = pair[0].bridge
    wait_until(lambda: set(INGRESS) <= set(bridge.describe()["observed"]), what="the blanket")
    heard = Heard(pair[1].node(), "honest")
    wait_until(lambda: "honest" in pair[1].bridge.describe()["subscriptions"], what="the subscription")
    fence(pair[1], pair[0])
    pair[0].node().put("honest", "x")
    wait_until(lambda: heard.samples, what="the sample")
    for each in junk:
        each.undeclare()
    wait_until(lambda: bridge.describe()["observed"] == ["honest"], what="what is wanted alone")


def test_what_is_to_be_retained_is_taken_though_nobody_is_there(pair):
    """A robot that wants it may be away; whoever comes and goes, nothing else is taken from applications."""
    bridge = pair[0].bridge
    bridge.retain(("covered/a", "covered/b"))
    wait_until(lambda: bridge.describe()["observed"] == ["covered/a", "covered/b"], what="both")
    heard = Heard(pair[1].node(), "covered/**")
    fence(pair[1], pair[0])
    both = ["covered/a", "covered/b"]
    wait_until(lambda: bridge.describe()["observed"] == ["covered/**", *both], what="what includes them, beside them")
    heard.subscriber.undeclare()
    wait_until(lambda: bridge.describe()["observed"] == ["covered/a", "covered/b"], what="them alone again")
    bridge.retain(())
    wait_until(lambda: not bridge.describe()["observed"], what="nothing")
