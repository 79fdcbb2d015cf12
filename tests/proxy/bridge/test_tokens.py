"""Presence tokens as they come and go."""

import pytest

from proxy.bridge import keys, tokens
from proxy.bridge.tokens import Tokens
from proxy.core.events import MalformedHeard, PeerAppeared, PeerGone


@pytest.fixture
def posted():
    return []


@pytest.fixture
def made(posted):
    return Tokens("0a", posted.append)


def events(posted):
    found = [item() if callable(item) else item for item in posted]
    posted.clear()
    return found


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


def test_what_came_and_went_meanwhile_is_one_piece_of_news(made, posted):
    """The last word holds."""
    for there in (True, False, True, False):
        made.note(keys.alive("r2", "0b"), there=there)
    assert told(posted) == [(PeerGone, "r2", "0b")]


@pytest.mark.parametrize("token", [("r" * 129, "0b"), ("r2", "not-hex"), ("r2", "0" * 33)])
def test_tokens_of_no_robot_are_malformed(made, posted, token):
    """Names of any length, sessions that Zenoh has not."""
    made.note(keys.alive(*token), there=True)
    (event,) = events(posted)
    assert isinstance(event, MalformedHeard)
    assert (event.kind, len(event.robot) <= 128) == ("token:malformed", True)


def test_a_flood_of_tokens_is_bounded(made, posted, monkeypatch):
    """More than a mesh has robots are not believed, until others vanish."""
    monkeypatch.setattr(tokens, "MOST", 10)
    for number in range(30):
        made.note(keys.alive("r2", f"{number:x}b"), there=True)
    assert len(told(posted)) == 10
    made.note(keys.alive("r2", "0b"), there=False)
    made.note(keys.alive("r2", "fffb"), there=True)
    assert told(posted) == [(PeerGone, "r2", "0b"), (PeerAppeared, "r2", "fffb")]
