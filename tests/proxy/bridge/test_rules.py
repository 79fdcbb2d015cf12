"""What may cross: rules alone, and between two robots."""

from dataclasses import replace

import pytest
import zenoh
import zenoh.ext

from proxy.bridge import rules as rules_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.rules import Companion, Direction, Expressions, Rules, Verdict, companion
from proxy.config import BridgeConfig
from proxy.core.interface.events import InterestChanged, SamplesPassed
from tests.proxy.bridge import robots
from tests.proxy.bridge.robots import fence, fence_apps, wait_interest
from tests.proxy.nodes import Heard, answers
from tests.waiting import wait_until

NAME = "@ros2_lv/0/zid/0/7/{kind}/%/%r1/logger/%r1%rosout/Log_/RIHS01_a/::,:,:,:,,"


def rules(**bridge):
    """The rules of a `[bridge]`; `into` is its `in`."""
    if "into" in bridge:
        bridge["in"] = bridge.pop("into")
    return Rules(BridgeConfig.model_validate(bridge))


@pytest.mark.parametrize("key", ["a", "a/b/c", "@ros2_lv/0/x", "a/@adv/pub/x", "@mine/x"])
def test_by_default_everything_crosses(key):
    """Keys with verbatim chunks too, in both directions."""
    nothing = rules()
    verdict = Verdict.COMPANION if "@adv" in key else Verdict.ORDINARY
    assert nothing.outward(key) is verdict
    assert nothing.into.verdict(key) is verdict
    assert nothing.out.lets(key)


def test_everything_can_be_denied():
    """`**` alone is everything there is."""
    sealed = rules(out={"deny": ["**"]})
    assert sealed.outward("@ros2_lv/0/x") is sealed.outward("a/@adv/x") is sealed.outward("a") is Verdict.DENIED
    assert sealed.into.lets("a")


@pytest.mark.parametrize(
    ("key", "verdict"),
    [
        ("a/b", Verdict.ORDINARY),
        ("a/secret", Verdict.DENIED),
        ("a/secret/x", Verdict.DENIED),
        ("a/secret/x/@adv/pub/zid/1/_", Verdict.DENIED),
        ("a/stop", Verdict.BYPASS),
        ("a/stop/@adv/pub/zid/1/_", Verdict.COMPANION),
        ("a/secret/stop", Verdict.DENIED),
        ("b", Verdict.DENIED),
        ("b/stop", Verdict.DENIED),
        ("@a/b", Verdict.DENIED),
    ],
)
def test_a_denial_wins_over_all_else(key, verdict):
    """First what is denied, then what is allowed, then what bypasses; companions are as their key is."""
    found = rules(out={"allow": ["a/**"], "deny": ["a/secret/**"], "bypass": ["**/stop"]})
    assert found.outward(key) is verdict
    assert found.outward(key) is verdict  # remembered


@pytest.mark.parametrize(
    ("expression", "crosses"),
    [
        ("a/**", True),
        ("**", True),
        ("**/@adv/**", True),
        ("*/secret", True),
        ("a/secret/*", False),
        ("a/secret/**/@adv/**", False),
        ("b/**", False),
    ],
)
def test_an_expression_crosses_unless_it_lies_wholly_outside(expression, crosses):
    """One that only overlaps with what is denied, or with what is allowed, crosses."""
    assert rules(into={"allow": ["a/**"], "deny": ["a/secret/**"]}).into.lets(expression) is crosses


@pytest.mark.parametrize("key", ["**", "a/**", "a/*/x", "*/secret/x", "a/s$*", "a/secret/*", "b/**", "a/**/@adv/pub/x"])
def test_a_sample_on_a_key_expression_needs_leave_for_all_its_keys(key):
    """Who subscribes to one of them gets it: a peer reached denied keys by publishing on `**`."""
    found = rules(into={"allow": ["a/**"], "deny": ["a/secret/**"]})
    assert found.into.verdict(key) is Verdict.DENIED
    assert found.into.verdict("a/public/*") is Verdict.ORDINARY


def test_companions_are_found():
    """Advanced pub/sub keys and ROS 2 tokens belong to a key, all else to none."""
    assert companion("a/b/@adv/pub/zid/1/_") == Companion("a/b", takes=False)
    assert companion("a/b/@adv/sub/zid/1/_") == Companion("a/b", takes=True)
    for kind, takes in (("MP", False), ("SS", False), ("MS", True), ("SC", True)):
        assert companion(NAME.format(kind=kind)) == Companion("0/r1/rosout/Log_/RIHS01_a", takes)
    assert companion("@ros2_lv/0/zid/0/0/NN/%/%/talker") is None
    for kind, takes in (("MP", False), ("SS", False), ("AS", False), ("MS", True), ("SC", True), ("AC", True)):
        bridged = f"@/zid/@ros2_lv/{kind}/r1§chatter/std_msgs§msg§String"
        assert companion(bridged) == companion(f"{bridged}/:::") == Companion("r1/chatter", takes)
    assert companion("@/zid/@ros2_lv") is None
    assert companion("a/b") is None


def test_tokens_of_those_who_take_follow_the_other_direction():
    """A robot that keeps its topic hides its publishers, and the others' subscribers from its publishers."""
    found = rules(out={"deny": ["*/**/rosout/*/*"]})
    publisher, subscriber, node = (NAME.format(kind=kind) for kind in ("MP", "MS", "NN"))
    both = {publisher: False, subscriber: False, "@ros2_lv/0/z/0/0/NN/%/%/n": False}
    assert publisher not in found.tokens(found.out, both)
    assert subscriber in found.tokens(found.out, both)
    assert found.describe()["out"]["tokens"] == len({publisher, node}) - 1
    assert subscriber not in found.tokens(found.into, both)
    assert publisher in found.tokens(found.into, both)


def test_tokens_can_be_named_themselves():
    """Rules may speak of the tokens as they are."""
    found = rules(into={"allow": ["@ros2_lv/0/**"], "deny": ["@ros2_lv/*/*/*/*/SC/**"]})
    declared = {NAME.format(kind=kind): False for kind in ("MP", "MS", "SC")} | {"other": False}
    assert sorted(found.tokens(found.into, declared)) == sorted(NAME.format(kind=kind) for kind in ("MP", "MS"))


def test_a_strange_token_does_no_harm():
    """What names no key belongs to no rule."""
    assert not Expressions(["a"]).cover("0//a")
    found = rules(out={"deny": ["*/x/**"]})
    strange = NAME.format(kind="MP").replace("%r1%rosout", "%a%%b")
    assert found.tokens(found.out, {strange: False}) == {strange: False}


@pytest.mark.parametrize(
    ("topic", "verdict"),
    [
        ("rosout", Verdict.DENIED),
        ("parameter_events", Verdict.DENIED),
        ("tf", Verdict.DENIED),
        ("r1/tf", Verdict.DENIED),
        ("tf_static", Verdict.BYPASS),
        ("cmd_vel", Verdict.BYPASS),
        ("fleet/r1/cmd_vel", Verdict.BYPASS),
        ("e_stop", Verdict.BYPASS),
        ("robot_description", Verdict.BYPASS),
        ("map", Verdict.BYPASS),
        ("fibonacci/_action/feedback", Verdict.BYPASS),
        ("camera/image_raw", Verdict.ORDINARY),
        ("tf/more", Verdict.ORDINARY),
    ],
)
def test_the_profile_for_ros_2(topic, verdict):
    """It speaks of topics of any domain, namespace and type, and lists of one's own add to it."""
    found = rules(profile="ros2", out={"deny": ["*/mine/*/*"], "bypass": ["*/horn/*/*"]})
    for domain in (0, 42):
        assert found.outward(f"{domain}/{topic}/pkg::msg::dds_::Type_/RIHS01_abc") is verdict
    assert found.outward("0/mine/T/h") is Verdict.DENIED
    assert found.outward("0/horn/T/h") is Verdict.BYPASS
    assert found.into.verdict(f"0/{topic}/T/h") is Verdict.ORDINARY


def test_of_too_many_declarations_those_that_have_crossed_stay(monkeypatch, caplog):
    """Others wait until there is room; how many is said, in the log once a minute."""
    now = 1000.0
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now)
    rules = Rules(BridgeConfig.model_validate({"out": {"deny": ["secret/**"]}}))
    honest = {"secret/a": False, "zz/steady": False}
    assert set(rules.out.crossing("subscribers", honest)) == {"zz/steady"}
    flood = {f"flood/{number}": False for number in range(BOUNDS.crossing["subscribers"] + 10)} | honest
    for number in range(3):
        crossing = rules.out.crossing("subscribers", flood | {f"more/{number}": False})
        assert len(crossing) == BOUNDS.crossing["subscribers"]
        assert "zz/steady" in crossing
    said = "other nodes declared too many subscribers: for 13 of them all that applications publish is taken in"
    assert rules.warnings() == [said]
    assert len([record for record in caplog.records if "too many" in record.getMessage()]) == 1
    for key in list(flood)[:100]:
        del flood[key]
    assert set(rules.out.crossing("subscribers", flood)) == flood.keys() - {"secret/a"}
    assert rules.warnings() == []
    now += 60.0
    rules.into.crossing("queryables", dict.fromkeys(map(str, range(BOUNDS.crossing["queryables"] + 1)), True))
    assert rules.warnings() == ["other nodes declared too many queryables: 1 have no effect until others are gone"]


def test_what_is_denied_is_counted():
    """Denials by kind, and how many declarations are not shown now."""
    direction = Direction(["**"], ["a/**"])
    assert direction.admits("queries", "b")
    assert not direction.admits("queries", "a/x")
    direction.count("samples")
    assert direction.crossing("queryables", {"a/x": True, "b": False, "**": True}) == {"b": False, "**": True}
    assert direction.describe() == {
        "samples": 1,
        "queries": 1,
        "replies": 0,
        "subscribers": 0,
        "queryables": 1,
        "tokens": 0,
    }
    direction.crossing("queryables", {})
    assert direction.describe()["queryables"] == 0


@pytest.fixture
def start(stack, tmp_path):
    """Two robots, the first with rules."""

    def with_rules(first, second=None):
        return robots.team(stack, tmp_path, size=2, rules=(first, second))

    return with_rules


def passed(robot):
    """Samples by reason."""
    totals = {}
    for event in robot.posted(SamplesPassed):
        totals[event.reason] = totals.get(event.reason, 0) + event.count
    return totals


def test_samples_and_deletes_that_may_not_leave_are_dropped_and_counted(start):
    """Local applications hear them, others do not; what is beside them passes."""
    pair = start({"out": {"deny": ["secret/**"]}})
    local, remote = Heard(pair[0].node(), "**"), Heard(pair[1].node(), "**")
    for robot, other in (pair, pair[::-1]):
        wait_interest(robot, other, keys=("**",))
    app = pair[0].node()
    app.put("secret/a", "1")
    app.delete("secret/a")
    app.put("open", "2")
    wait_until(lambda: remote.samples, what="the open one")
    wait_until(lambda: len(local.samples) == 3, what="local delivery")
    assert [str(sample.key_expr) for sample in remote.samples] == ["open"]
    wait_until(lambda: sum(passed(pair[0]).values()) == 3, what="the counts")
    assert passed(pair[0]) == {"dropped:denied": 2, "passed:no-spec": 1}
    assert pair[0].bridge.describe()["denied"]["out"]["samples"] == 2


def test_what_may_not_come_in_does_not_reach_the_apps(start):
    """A subscription inside what is denied is not shown to others; one that overlaps is, and is filtered."""
    pair = start({"in": {"deny": ["secret/**"]}})
    inside, around = Heard(pair[0].node(), "secret/a"), Heard(pair[0].node(), "**")
    wait_interest(pair[0], pair[1], keys=("**",))
    assert pair[0].posted(InterestChanged)[-1].keys == ("**",)
    app = pair[1].node()
    for key in ("secret/a", "**", "open"):
        app.put(key, "1")
    wait_until(lambda: around.samples, what="the open one")
    assert [str(sample.key_expr) for sample in around.samples] == ["open"]
    assert not inside.samples
    denied = pair[0].bridge.describe()["denied"]["in"]
    assert (denied["samples"], denied["subscribers"]) == (2, 1)


def test_queryables_are_hidden_and_queries_around_them_lack_their_answers(start):
    """What lies inside is not answered; a query that overlaps crosses, without the answers on denied keys."""
    pair = start({"out": {"deny": ["secret/**"]}})
    server, asker = pair[0].node(), pair[1].node()

    def answer(query):
        for key in ("secret/a", "open"):
            if query.key_expr.intersects(key):
                query.reply(key, key)

    server.declare_queryable("secret/*", answer)
    server.declare_queryable("**", answer)
    wait_until(lambda: "**" in pair[0].bridge.describe()["queryables"]["inward"], what="the open queryable")
    fence(pair[0], pair[1])
    wait_until(lambda: "**" in pair[1].bridge.describe()["queryables"]["outward"], what="its mirror")
    fence_apps(pair[1])
    assert pair[0].bridge.describe()["queryables"]["inward"] == ["**"]
    assert list(answers(asker, "open")) == ["open"]
    assert list(answers(asker, "secret/a")) == []
    assert list(answers(asker, "*/**", target=zenoh.QueryTarget.ALL)) == ["open"]
    assert sorted(answers(pair[0].node(), "secret/a")) == ["secret/a"]
    denied = pair[0].bridge.describe()["denied"]["out"]
    assert (denied["queryables"], denied["queries"], denied["replies"]) == (1, 1, 2)


def test_tokens_are_hidden(start):
    """A token that may not come in is not seen here, and one that may not leave not there."""
    pair = start({"in": {"deny": ["noise/**"]}, "out": {"deny": ["secret/**"]}})
    apps = [robot.node() for robot in pair]
    kept = [
        app.liveliness().declare_token(f"{key}/{name}")
        for app, name in zip(apps, "ab", strict=True)
        for key in ("noise", "secret", "open")
    ]

    def seen(app):
        return {str(reply.ok.key_expr) for reply in app.liveliness().get("**", timeout=5.0) if reply.ok}

    expected = [
        {"open/a", "open/b", "noise/a", "secret/a", "secret/b"},
        {"open/a", "open/b", "noise/a", "noise/b", "secret/b"},
    ]
    for app, tokens in zip(apps, expected, strict=True):
        wait_until(lambda app=app, tokens=tokens: seen(app) >= tokens, what="the open tokens")
    assert [seen(app) for app in apps] == expected
    denied = pair[0].bridge.describe()["denied"]
    assert (denied["out"]["tokens"], denied["in"]["tokens"]) == (1, 1)
    del kept


def test_an_advanced_publisher_that_is_denied_keeps_its_history_too(start):
    """Neither what it publishes nor what it remembers is to be had from the other robot."""
    pair = start({"out": {"deny": ["secret/**"]}})
    options = {"cache": zenoh.ext.CacheConfig(max_samples=3), "publisher_detection": True}
    app = pair[0].node(stamps=True)
    publishers = [zenoh.ext.declare_advanced_publisher(app, key, **options) for key in ("secret/a", "open/a")]
    for publisher in publishers:
        publisher.put("old")
    heard = []
    subscribers = [
        zenoh.ext.declare_advanced_subscriber(
            pair[1].node(),
            key,
            lambda sample: heard.append(str(sample.key_expr)),
            history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
        )
        for key in ("secret/a", "open/a")
    ]
    wait_until(lambda: heard, what="the open history")
    wait_interest(pair[1], pair[0], keys=("open/a",))
    for publisher in publishers:
        publisher.put("new")
    wait_until(lambda: len(heard) == 2, what="the open sample")
    assert heard == ["open/a", "open/a"]
    assert pair[0].bridge.describe()["denied"]["out"]["queryables"] >= 1
    for each in (*subscribers, *publishers):
        each.undeclare()


def test_what_bypasses_waits_for_no_decision(start):
    """A sample of a covered key goes at once, and the core only learns how much it was."""
    pair = start({"out": {"bypass": ["covered/stop"]}})
    remote = Heard(pair[1].node(), "covered/**")
    wait_interest(pair[1], pair[0], keys=("covered/**",))
    app = pair[0].node()
    app.put("covered/a", "waits")
    app.put("covered/stop", "now")
    app.delete("covered/stop")
    wait_until(lambda: len(remote.samples) == 2, what="what bypasses")
    assert remote.payloads == ["now", ""]
    wait_until(lambda: passed(pair[0]).get("passed:bypass") == 2, what="the count")
    assert [event.key for event in pair[0].asked] == ["covered/a"]
    (size,) = [event.size for event in pair[0].posted(SamplesPassed) if event.size]
    assert size == len("now")


def test_of_tokens_that_are_gone_by_now_those_pass_that_cross(monkeypatch):
    """As many as there is room for."""
    rules = Rules(BridgeConfig.model_validate({"out": {"deny": ["private/**"]}}))
    assert list(rules.passing(rules.out, ["private/a", "public/a"])) == ["public/a"]
    assert list(rules.passing(rules.into, ["private/a", "public/a"])) == ["private/a", "public/a"]
    monkeypatch.setattr(rules_module, "BOUNDS", replace(BOUNDS, crossing={**BOUNDS.crossing, "tokens": 1}))
    assert list(rules.passing(rules.into, ["a", "b"])) == ["a"]
