"""Tokens that end and are declared anew at once."""

import pytest
import zenoh

from tests.proxy.bridge.robots import fence_apps
from tests.waiting import wait_until


@pytest.fixture
def seen(pair):
    """What an application of the other robot is told of a token that is alive."""
    found = []
    pair[0].token = pair[0].node().liveliness().declare_token("alive/a")
    handler = zenoh.handlers.Callback(lambda sample: found.append(sample.kind), indirect=False)
    pair[1].follows = pair[1].node().liveliness().declare_subscriber("alive/a", handler, history=True)
    wait_until(lambda: found, what="the token")
    return found


def blink(robot):
    """What the table does when the link tells that the token ended and is there again."""
    table = robot._sides.apps._table
    with table._lock:
        ((name, entry),) = table._entries["token"].items()
        table._forget("token", name)
        table._add("token", name, entry)
        table._change("token")
    table._changed()


BOTH = [zenoh.SampleKind.PUT, zenoh.SampleKind.DELETE, zenoh.SampleKind.PUT]


def test_both_are_told(pair, seen):
    """An application that starts again has a token of the same name."""
    blink(pair[0])
    wait_until(lambda: seen == BOTH, what="its end and its beginning")


def test_both_are_told_although_they_come_while_tokens_are_read(pair, seen, monkeypatch):
    """What ended is read before what is alive."""
    apps, done = pair[0]._sides.apps, []
    ended_tokens = apps.ended_tokens

    def ended(own):
        found = ended_tokens(own)
        if not done:
            done.append(blink(pair[0]))
        return found

    monkeypatch.setattr(apps, "ended_tokens", ended)
    blink(pair[0])
    wait_until(lambda: seen[:3] == BOTH and len(done) == 1, what="its end and its beginning")


def test_both_are_told_although_a_look_fails(pair, seen, monkeypatch):
    """The next one tells what that did not."""
    mirroring, failed = pair[0].bridge._mirroring, []
    subscribe = mirroring._subscribe

    def fails(now):
        if not failed:
            failed.append(now)
            raise zenoh.ZError("once")
        return subscribe(now)

    monkeypatch.setattr(mirroring, "_subscribe", fails)
    blink(pair[0])
    wait_until(lambda: seen == BOTH, what="its end and its beginning")
    assert failed


def test_tokens_that_are_there_for_a_moment_are_told(pair, seen):
    """Whoever watches sees each come and go, and the application's own robot sees it once."""
    told, near = [], []

    def watch(robot, to):
        take = zenoh.handlers.Callback(lambda sample: to.append((str(sample.key_expr), sample.kind)), indirect=False)
        return robot.node().liveliness().declare_subscriber("brief/*", take)

    watchers = watch(pair[1], told), watch(pair[0], near)
    wait_until(lambda: seen, what="the watchers")
    session = pair[0].node()
    fence_apps(pair[1])
    fence_apps(pair[0])
    expected = []
    for number in range(20):
        session.liveliness().declare_token(f"brief/{number}").undeclare()
        expected += [(f"brief/{number}", kind) for kind in (zenoh.SampleKind.PUT, zenoh.SampleKind.DELETE)]
    wait_until(lambda: sorted(told, key=str) == sorted(expected, key=str), what="all of them")
    last = session.liveliness().declare_token("brief/last")
    wait_until(lambda: told[-1][0] == near[-1][0] == "brief/last", what="the last one")
    assert near[:-1] == expected
    assert sorted(told[:-1], key=str) == sorted(expected, key=str)
    for thing in (last, *watchers):
        thing.undeclare()


def test_a_token_of_two_robots_is_told_until_both_have_ended(pair, seen):
    """Who declares what there is already, and ends it, takes nothing from its own robot's applications."""
    found = []
    near = pair[1].node()
    watcher = near.liveliness().declare_subscriber(
        "alive/a", zenoh.handlers.Callback(lambda sample: found.append(sample.kind), indirect=False), history=True
    )
    wait_until(lambda: found, what="the token of the other robot")
    token = pair[1].node().liveliness().declare_token("alive/a")
    mirroring = pair[1].bridge._mirroring
    wait_until(lambda: "alive/a" in mirroring._tokens_out.declared, what="the second one")
    token.undeclare()
    wait_until(lambda: not mirroring._tokens_out.declared, what="the end of the second one")
    wait_until(lambda: not mirroring._unsettled(), what="all echoes")
    pair[0].token.undeclare()
    wait_until(lambda: found[-1] == zenoh.SampleKind.DELETE, what="the end of the first one")
    assert found == seen == [zenoh.SampleKind.PUT, zenoh.SampleKind.DELETE]
    watcher.undeclare()


def test_nothing_is_kept_of_them_where_another_daemon_sees_to_the_applications(pair, seen, monkeypatch):
    """They are mirrored nowhere."""
    monkeypatch.setattr(type(pair[0].bridge._mirroring._neighbours), "aside", True)
    pair[0]._sides.wake.set()
    wait_until(lambda: seen[-1] == zenoh.SampleKind.DELETE, what="it to stand aside")
    blink(pair[0])
    wait_until(lambda: not pair[0]._sides.apps._table._ended, what="it to be forgotten")
