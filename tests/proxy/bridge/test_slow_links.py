"""Nobody waits long for a link that is slower than the others."""

import pytest

from proxy.bridge.slow_links import SlowLinks
from proxy.bridge.tuning import TUNING


class Links:
    """Links that are full or not, and a wait that lets something happen."""

    def __init__(self, slow, links):
        self.state = slow, links
        self.waits = 0

        self.written = {}

    def slow(self):
        return self.state

    def sent(self):
        return dict(self.written)


def test_nobody_waits_where_all_links_have_room_or_there_is_no_other():
    """What is full is the channel then, and Zenoh waits for it as it does."""
    for state in ((0, 3), (1, 1), (0, 0)):
        assert not SlowLinks(Links(*state), wait=lambda _: None).stays_full()


def test_where_all_are_full_the_first_that_has_room_again_is_not_held_up(monkeypatch):
    """Nothing is published before; the others are waited for no longer than ever, counted from the beginning."""
    now = [100.0]
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])
    links = Links(2, 2)

    def wait(seconds):
        now[0] += seconds
        if now[0] > 101.0:
            links.state = (1, 2)

    assert SlowLinks(links, wait).stays_full()
    assert 101.0 < now[0] < 101.01


def test_at_the_end_nobody_waits_any_more():
    """However full the links are."""
    slow = SlowLinks(Links(2, 2), wait=lambda _: slow.stop_waiting())
    assert not slow.stays_full()


def test_it_waits_until_the_slow_link_has_room():
    """Then nothing is dropped."""
    links = Links(1, 3)

    def wait(_):
        links.waits += 1
        links.state = (int(links.waits < 5), 3)

    slow = SlowLinks(links, wait)
    assert not slow.stays_full()
    assert (links.waits, slow.lost) == (5, 0)


def test_it_stays_full_once_and_rests(monkeypatch):
    """After the longest wait what comes next does not wait again, until it has rested."""
    now = [100.0]
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])

    def wait(seconds):
        now[0] += seconds

    slow = SlowLinks(Links(1, 2), wait)
    assert slow.calm
    assert slow.stays_full()
    assert not slow.calm
    assert TUNING.slow_link_wait <= now[0] - 100.0 < TUNING.slow_link_wait + 0.01
    before = now[0]
    assert slow.stays_full()
    assert now[0] == before
    assert slow.lost == 1
    now[0] += TUNING.slow_link_rest
    assert slow.calm
    assert slow.stays_full()
    assert slow.lost == 2


@pytest.fixture
def lost(monkeypatch):
    """A link that was waited for in vain, and what to do while others are."""
    now, doing = [100.0], []
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])

    def wait(seconds):
        now[0] += seconds
        links.waits += 1
        for do in doing:
            do()

    links = Links(1, 3)
    slow = SlowLinks(links, wait)
    assert slow.stays_full()
    links.waits = 0
    links.written = {"keeps up": 1000, "another": 50}
    return slow, links, doing, now


def test_where_samples_may_be_dropped_each_waits_until_links_with_room_have_the_one_before(lost):
    """Only links to those who want them count, and only for as long as they have room."""
    slow, links, doing, _ = lost
    slow.await_previous(500, {"keeps up", "slow"})
    assert links.waits == 0
    doing.append(lambda: links.written.update({"keeps up": 1000 + 100 * links.waits}))
    slow.await_previous(500, {"keeps up", "slow"})
    assert links.waits == 5
    doing.clear()
    del links.written["keeps up"]
    slow.await_previous(500, {"keeps up"})
    assert links.waits == 5


def test_a_link_that_sends_nothing_is_waited_for_once(lost):
    """Zenoh dropped the sample there, or nobody wants it any more; what comes next does not wait for that again."""
    slow, links, _, now = lost
    slow.await_previous(500, {"another", "keeps up"})
    links.written["keeps up"] += 500
    before = now[0]
    slow.await_previous(500, {"another", "keeps up"})
    assert TUNING.slow_link_wait <= now[0] - before < TUNING.slow_link_wait + 0.01
    before = now[0]
    for _ in range(5):
        links.written["keeps up"] += 500
        slow.await_previous(500, {"another", "keeps up"})
    assert now[0] == before


def test_at_the_end_no_link_is_waited_for(lost):
    """However much it lacks."""
    slow, links, doing, _ = lost
    slow.await_previous(500, {"another"})
    doing.append(slow.stop_waiting)
    slow.await_previous(500, {"another"})
    assert links.waits == 1


def test_after_its_rest_nothing_is_looked_at(lost):
    """All links take what comes."""
    slow, links, _, now = lost
    slow.await_previous(500, {"another"})
    now[0] += TUNING.slow_link_rest
    slow.await_previous(500, {"another"})
    slow.await_previous(500, {"another"})
    assert links.waits == 0
