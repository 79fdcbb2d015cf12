"""Of samples that wait for room only those are looked at that lead."""

import pytest

from proxy.core.model.waiting import Waiting
from proxy.core.samples.followers import Followers
from proxy.core.samples.inbox import Inbox


@pytest.fixture
def inbox():
    return Inbox(capacity=10, backlog=10)


@pytest.fixture
def followers(inbox):
    return Followers(inbox)


def put(inbox, number, size, priority=5, key=""):
    waiting = Waiting(number, key or f"k{number}", size, 0.01 * number, 1.0, priority, markovian=False)
    inbox.put(waiting)
    assert inbox.take(lambda each: each is not waiting) is waiting
    inbox.put(waiting)
    return waiting, (float(size),)


def rests(inbox, followers, number, size, kind="", **rest):
    """A sample waits behind another one, or else for room that opens at 5.0; return when there is none before."""
    waiting, use = put(inbox, number, size, **rest)
    before = followers.follow(kind, waiting, use)
    if before is None:
        followers.lead(kind, waiting, use, 5.0)
    inbox.rest(waiting, 9.0)
    return before


def test_what_comes_later_and_is_no_smaller_follows(inbox, followers):
    """It finds no room before the other one does."""
    assert rests(inbox, followers, 1, 100) is None
    assert rests(inbox, followers, 2, 100) == 5.0
    assert rests(inbox, followers, 3, 99) is None
    assert rests(inbox, followers, 4, 150, priority=4) is None
    assert followers


def test_what_comes_later_of_a_key_follows_however_it_stands_and_however_small_it_is(inbox, followers):
    """Where each counts they would go in another order than they came."""
    assert rests(inbox, followers, 1, 100, key="k") is None
    assert rests(inbox, followers, 2, 10, kind="other", key="k") == 5.0
    assert rests(inbox, followers, 3, 10, kind="other") is None


def test_what_comes_later_of_a_key_waits_for_one_that_follows_another_key(inbox, followers):
    """However it stands: alone it would find room before the one that it comes after."""
    assert rests(inbox, followers, 1, 100) is None
    assert rests(inbox, followers, 2, 100, key="k") == 5.0
    assert rests(inbox, followers, 3, 10, kind="other", key="k") == 5.0
    inbox.wake_one(1)
    inbox.take()
    followers.release()
    assert (inbox.take().sample, inbox.take()) == (2, None)
    followers.release()
    assert inbox.take().sample == 3


def test_followers_that_left_are_forgotten_when_the_next_one_of_their_key_comes(inbox, followers):
    """A leader waits for an hour where a window is as long. Of its followers each new one drives another one out."""
    assert rests(inbox, followers, 1, 100, priority=1) is None
    for number in range(2, 100):
        assert rests(inbox, followers, number, 100, key="k") == 5.0
    remembered = [len(each) for each in (*followers._following.values(), *followers._keys.values())]
    assert len(remembered) == 2
    assert max(remembered) <= 10


def test_when_its_leader_has_left_it_may_be_taken(inbox, followers):
    """The first one of those that followed leads the others, as far as they are no smaller."""
    for number, size in ((1, 100), (2, 120), (3, 130), (4, 110)):
        rests(inbox, followers, number, size)
    assert inbox.take() is None
    inbox.wake_one(1)
    assert inbox.take().sample == 1
    followers.release()
    assert [inbox.take().sample, inbox.take().sample, inbox.take()] == [2, 4, None]
    followers.release()
    assert inbox.take().sample == 3


def test_one_that_left_leads_nobody(inbox, followers):
    """Samples that were evicted, or woke as they are too old, are passed over."""
    for number, size in ((1, 100), (2, 120), (3, 130)):
        rests(inbox, followers, number, size)
    inbox.supersede("k1")
    inbox.wake_one(1)
    inbox.take()
    inbox.wake_one(2)
    inbox.take()
    followers.release()
    assert inbox.take().sample == 3
    followers.release()
    assert not followers
