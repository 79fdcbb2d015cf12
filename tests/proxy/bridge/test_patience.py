"""Nobody waits long for a link that is slower than the others."""

import pytest

from proxy.bridge.patience import LONGEST, REST, Patience


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
        assert not Patience(Links(*state), wait=lambda _: None).runs_out()


def test_where_all_are_full_the_first_that_has_room_again_is_not_held_up(monkeypatch):
    """Nothing is published before; the others are waited for no longer than ever, counted from the beginning."""
    now = [100.0]
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])
    links = Links(2, 2)

    def wait(seconds):
        now[0] += seconds
        if now[0] > 101.0:
            links.state = (1, 2)

    assert Patience(links, wait).runs_out()
    assert 101.0 < now[0] < 101.01


def test_at_the_end_nobody_waits_any_more():
    """However full the links are."""
    patience = Patience(Links(2, 2), wait=lambda _: patience.end())
    assert not patience.runs_out()


def test_it_waits_until_the_slow_link_has_room():
    """Then nothing is dropped."""
    links = Links(1, 3)

    def wait(_):
        links.waits += 1
        links.state = (int(links.waits < 5), 3)

    patience = Patience(links, wait)
    assert not patience.runs_out()
    assert (links.waits, patience.lost) == (5, 0)


def test_it_runs_out_once_and_rests(monkeypatch):
    """After the longest wait what comes next does not wait again, until it has rested."""
    now = [100.0]
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])

    def wait(seconds):
        now[0] += seconds

    patience = Patience(Links(1, 2), wait)
    assert patience.at_ease
    assert patience.runs_out()
    assert not patience.at_ease
    assert LONGEST <= now[0] - 100.0 < LONGEST + 0.01
    before = now[0]
    assert patience.runs_out()
    assert now[0] == before
    assert patience.lost == 1
    now[0] += REST
    assert patience.at_ease
    assert patience.runs_out()
    assert patience.lost == 2


@pytest.fixture
def lost(monkeypatch):
    """A patience that has run out, its links, and what to do while it waits."""
    now, doing = [100.0], []
    monkeypatch.setattr("proxy.clock.monotonic", lambda: now[0])

    def wait(seconds):
        now[0] += seconds
        links.waits += 1
        for do in doing:
            do()

    links = Links(1, 3)
    patience = Patience(links, wait)
    assert patience.runs_out()
    links.waits = 0
    links.written = {"keeps up": 1000, "another": 50}
    return patience, links, doing, now


def test_where_samples_may_be_dropped_each_waits_until_links_with_room_have_the_one_before(lost):
    """Only links to those who want them count, and only for as long as they have room."""
    patience, links, doing, _ = lost
    patience.hand(500, {"keeps up", "slow"})
    assert links.waits == 0
    doing.append(lambda: links.written.update({"keeps up": 1000 + 100 * links.waits}))
    patience.hand(500, {"keeps up", "slow"})
    assert links.waits == 5
    doing.clear()
    del links.written["keeps up"]
    patience.hand(500, {"keeps up"})
    assert links.waits == 5


def test_a_link_that_sends_nothing_is_waited_for_once(lost):
    """Zenoh dropped the sample there, or nobody wants it any more; what comes next does not wait for that again."""
    patience, links, _, now = lost
    patience.hand(500, {"another", "keeps up"})
    links.written["keeps up"] += 500
    before = now[0]
    patience.hand(500, {"another", "keeps up"})
    assert LONGEST <= now[0] - before < LONGEST + 0.01
    before = now[0]
    for _ in range(5):
        links.written["keeps up"] += 500
        patience.hand(500, {"another", "keeps up"})
    assert now[0] == before


def test_at_the_end_no_link_is_waited_for(lost):
    """However much it lacks."""
    patience, links, doing, _ = lost
    patience.hand(500, {"another"})
    doing.append(patience.end)
    patience.hand(500, {"another"})
    assert links.waits == 1


def test_after_its_rest_nothing_is_looked_at(lost):
    """All links take what comes."""
    patience, links, _, now = lost
    patience.hand(500, {"another"})
    now[0] += REST
    patience.hand(500, {"another"})
    patience.hand(500, {"another"})
    assert links.waits == 0
