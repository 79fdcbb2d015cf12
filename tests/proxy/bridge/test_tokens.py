"""Presence tokens as they come and go."""

from dataclasses import replace

import pytest

from proxy.bridge import keys, tokens
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.tokens import Tokens
from proxy.core.interface.events import PeerAppeared, PeerGone


@pytest.fixture
def posted():
    return []


@pytest.fixture
def refused():
    return []


@pytest.fixture
def turns():
    """The tags of robots that vanished or came back, as told at once."""
    return []


@pytest.fixture
def absent():
    """Sessions to which there is no link."""
    return set()


@pytest.fixture
def little_room(monkeypatch):
    """For ten tokens."""
    monkeypatch.setattr(tokens, "BOUNDS", replace(BOUNDS, tokens=10))


@pytest.fixture
def made(posted, refused, now, turns, absent):
    def later(when, job):
        posted.append(lambda: job() if now[0] >= when else posted.append(lambda: later(when, job)))

    return Tokens(
        "0a",
        posted.append,
        later,
        lambda _now, *what: refused.append(what),
        lost=lambda tag: turns.append((tag, False)),
        found=lambda tag: turns.append((tag, True)),
        forged=lambda robot, zid: (robot, zid) == ("r9", "0b"),
        absent=absent.__contains__,
        strange=absent.__contains__,
    )


def events(posted):
    waiting, posted[:] = list(posted), []
    return [event for item in waiting if (event := item()) is not None]


def told(posted):
    return [(type(event), event.robot, event.zid) for event in events(posted)]


def test_robots_come_and_go(made, posted):
    """Our own token is no news."""
    made.note(keys.alive("r1", "0a"), there=True)
    made.note(keys.alive("r2", "0b"), there=True)
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    made.note(keys.alive("r2", "0b"), there=False)
    assert told(posted) == [(PeerGone, "r2", "0b")]
    made.note(keys.alive("r2", "0b"), there=False)
    assert told(posted) == []


def test_who_was_gone_before_anybody_knew_of_it_is_no_news(made, posted, refused):
    """A flood of tokens that come and go leaves nothing behind that others would have to wait for."""
    for number in range(int(BOUNDS.all_token_changes_at_once) + 50):
        for there in (True, False):
            made.note(keys.alive("flood", f"{number:x}"), there=there)
        if number == BOUNDS.all_token_changes_at_once / 2:
            assert told(posted) == []
    made.note(keys.alive("r2", "0b"), there=True)
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    assert refused == []


def test_a_session_in_another_robots_name_is_refused(made, posted, refused):
    """Before that robot is there and after: it comes and goes with its own token alone."""
    made.note(keys.alive("r9", "0b"), there=True)
    made.note(keys.alive("r2", "0b"), there=True)
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    assert refused == [("r9", "token:forged")]


def test_a_token_of_whom_there_is_no_link_to_waits_for_one(made, posted, refused, now, absent):
    """It is refused once, and believed as soon as there is one; where it vanishes before there is nothing to tell."""
    absent |= {"0b", "0c"}
    made.note(keys.alive("r2", "0b"), there=True)
    made.note(keys.alive("r3", "0c"), there=True)
    for _ in range(3):
        assert told(posted) == []
        now[0] += BOUNDS.unlinked_retry
    assert refused == [("r2", "token:no link"), ("r3", "token:no link")]
    made.note(keys.alive("r3", "0c"), there=False)
    absent.clear()
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    now[0] += BOUNDS.unlinked_retry
    assert told(posted) == []


@pytest.mark.usefixtures("little_room")
def test_tokens_without_a_link_take_no_room_from_others(made, posted, absent, turns, now):
    """However many: a robot that comes later is believed; they count as robots once they are linked."""
    ghosts = [f"{number:x}c" for number in range(30)]
    absent |= set(ghosts)
    for zid in ghosts:
        made.note(keys.alive("ghost", zid), there=True)
    assert told(posted) == []
    made.note(keys.alive("r2", "0b"), there=True)
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    assert (list(made.tags), turns) == (["0b"], [("0b", True)])
    absent.discard(ghosts[0])
    found = []
    for _ in range(3):
        now[0] += BOUNDS.unlinked_retry
        found += told(posted)
    assert found == [(PeerAppeared, "ghost", ghosts[0])]
    assert turns == [("0b", True), (ghosts[0], True)]
    for zid in ghosts:
        made.note(keys.alive("ghost", zid), there=False)
    assert list(made.tags) == ["0b"]


def test_that_a_robot_vanished_or_is_back_is_told_at_once(made, turns):
    """Whatever becomes of the event; a second token of a robot is nothing new, our own never."""
    other = keys.alive("r3", "0b")
    for token, there in ((keys.alive("r2", "0b"), True), (other, True), (keys.alive("r1", "0a"), True)):
        made.note(token, there=there)
    assert turns == [("0b", True)]
    for there in (False, True):
        made.note(other, there=there)
    assert turns == [("0b", True)]
    for token in (other, keys.alive("r2", "0b"), keys.alive("r2", "0b")):
        made.note(token, there=False)
    made.note(other, there=True)
    assert turns == [("0b", True), ("0b", False), ("0b", True)]


def test_what_came_and_went_meanwhile_is_one_piece_of_news(made, posted):
    """The last word holds."""
    made.note(keys.alive("r2", "0b"), there=True)
    assert told(posted) == [(PeerAppeared, "r2", "0b")]
    for there in (False, True, False):
        made.note(keys.alive("r2", "0b"), there=there)
    assert told(posted) == [(PeerGone, "r2", "0b")]


@pytest.mark.parametrize("token", [("r" * 129, "0b"), ("r2", "not-hex"), ("r2", "0" * 33)])
def test_tokens_of_no_robot_are_malformed(made, posted, refused, token):
    """Names of any length, sessions that Zenoh has not."""
    made.note(keys.alive(*token), there=True)
    ((robot, kind),) = refused
    assert (kind, len(robot) <= 128, events(posted)) == ("token:malformed", True, [])


@pytest.mark.usefixtures("little_room")
def test_a_flood_of_tokens_is_bounded(made, posted):
    """More than a mesh has robots are not believed, until others vanish."""
    for number in range(30):
        made.note(keys.alive("r2", f"{number:x}b"), there=True)
    assert len(told(posted)) == 10
    made.note(keys.alive("r2", "0b"), there=False)
    made.note(keys.alive("r2", "fffb"), there=True)
    assert told(posted) == [(PeerGone, "r2", "0b"), (PeerAppeared, "r2", "fffb")]


def test_a_robot_that_comes_and_goes_without_end_is_news_once_in_a_while(made, posted, refused, now):
    """Each time all robots share the channel anew; the last word is never lost."""
    news = []
    for step in range(100):
        made.note(keys.alive("r2", "0b"), there=step % 2 == 0)
        news += told(posted)
        now[0] += 0.05
    now[0] += 1.0
    news += told(posted)
    assert len(news) <= BOUNDS.token_changes_at_once + 6.0 * BOUNDS.token_changes
    assert news[-1] == (PeerGone, "r2", "0b")
    assert set(refused) == {("r2", "token:flood")}


def test_changes_of_all_robots_together_are_bounded(made, posted, now):
    """A flood of tokens is taken in by and by; whoever is there is told of in the end."""
    robots = int(BOUNDS.all_token_changes_at_once) + 40
    for number in range(robots):
        made.note(keys.alive("r2", f"{number:x}b"), there=True)
    assert len(told(posted)) == BOUNDS.all_token_changes_at_once
    found = 0
    for _ in range(200):
        now[0] += 0.1
        news = len(told(posted))
        assert news <= BOUNDS.all_token_changes * 0.1 + 1
        found += news
    assert found == 40
