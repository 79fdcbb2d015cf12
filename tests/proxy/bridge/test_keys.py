"""Keys of Sendworthy itself, and which expressions cross."""

import pytest
import zenoh

from proxy.bridge import keys


def test_keys_tell_their_robot_and_session():
    """What is put into a key can be read from it."""
    token = keys.alive("r1", "ab12")
    assert (keys.robot_of(token), keys.zid_of(token)) == ("r1", "ab12")
    assert {keys.robot_of(make("r1")) for make in (keys.status, keys.mode)} == {"r1"}
    for key in (keys.digest("r1", "ab12"), keys.state("r1", "ab12")):
        assert (keys.robot_of(key), keys.zid_of(key)) == ("r1", "ab12")


def test_subscriptions_to_all_robots_match_each():
    """The expressions for all robots include the keys of one."""
    for all_robots, one in (
        (keys.ALL_DIGESTS, keys.digest("r1", "ab")),
        (keys.ALL_STATES, keys.state("r1", "ab")),
        (keys.ALL_ALIVE, keys.alive("r1", "ab12")),
    ):
        assert zenoh.KeyExpr(all_robots).includes(one)


@pytest.mark.parametrize("alarm", ["robot/r1/alarm", "alarm/@cam/x", "@adv/a", "100%25/%40/a%b"])
def test_copies_go_where_one_robot_hears_them_and_tell_their_key(alarm):
    """No application matches them, and neither does another robot."""
    key = keys.kept("ab12cd34", alarm)
    assert keys.kept_of(key) == alarm
    assert zenoh.KeyExpr(keys.kept("ab12cd34", "*/**")).includes(key)
    assert not zenoh.KeyExpr(keys.kept("ab12cd35", "*/**")).intersects(key)
    assert not keys.on_air(key)


@pytest.mark.parametrize("key", ["@sendworthy/**", "@sendworthy/*/**", "@sendworthy/*/kept", "@sendworthy/*/*/**"])
def test_what_matches_the_keys_of_copies_and_is_none(key):
    """Whoever puts a sample on an expression sends it to all who listen for what it matches."""
    assert keys.kept_of(key) == ""


def test_no_wildcard_of_an_app_matches_own_keys():
    """Verbatim chunks keep Sendworthy's keys apart."""
    assert not zenoh.KeyExpr("**").intersects(keys.digest("r1", "ab"))


def test_ingress_receives_every_key_that_crosses_in_words_of_its_own():
    """The expressions of ingress are canonical, cover what crosses, and are not what an app would write."""
    covered = [zenoh.KeyExpr(expression) for expression in keys.INGRESS]
    for key in ("a", "a/b", "a/@adv/pub/x", "@ros2_lv/0/x"):
        assert sum(expression.includes(key) for expression in covered) == 1
    assert not set(keys.INGRESS) & set(keys.CROSSING)
    assert all(keys.crosses(expression) for expression in keys.CROSSING)


def test_what_concerns_sessions_and_daemons_themselves_does_not_cross():
    """The admin space and our own keys stay, in whatever chunk they begin; other verbatim chunks cross."""
    for expression in ("@/**", "@/abc/router", "@sendworthy/r1/status", "**/@sendworthy/**", "**/@/**", "@"):
        assert not keys.crosses(expression)
    for expression in (
        "@/*/**",
        "@/abc",
        "@/abc/router/@x",
        "a/@/abc/@x",
        "@/@/@x",
        "@/abc/@x/@/b",
        "@/abc/@x/@sendworthy",
    ):
        assert not keys.crosses(expression)
    for expression in ("@adv/a", "a/@x/**", "@sendworthyish/a", "@ros2_lv/**"):
        assert keys.crosses(expression)


def test_what_plugins_of_zenoh_tell_each_other_of_crosses():
    """The tokens of bridges stand in the admin space, below a verbatim chunk: no router answers for them."""
    for expression in ("@/abc/@ros2_lv", "@/abc/@ros2_lv/MP/chatter/std_msgs§msg§String/:::", "@/*/@mavlink/**"):
        assert keys.crosses(expression)
