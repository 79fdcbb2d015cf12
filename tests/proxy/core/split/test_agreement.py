"""What robots agree on."""

from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.protocol.split_report import SplitReport
from proxy.core.split.tuning import TUNING
from tests.proxy.core.split.agreeing import BID, agree, robot, tell


def test_two_robots_agree_when_each_has_heard_that_the_other_has_the_same_table():
    """Until then both are newcomers."""
    a, b = robot("a", "b"), robot("b", "a")
    tell(0.1, a, b)
    assert (a.entitled, b.entitled) == (200 // TUNING.newcomers, 200 // TUNING.newcomers)
    tell(0.1, b, a)
    assert a.log.newest.name == b.log.newest.name
    assert (a.newcomer, b.newcomer) == (False, True)
    tell(0.2, a, b)
    assert not b.newcomer
    tell(0.3, b, a)
    assert (a.settled, a.known_by >= a.others, a.entitled + b.entitled) == (True, True, UNIT - 200)


def test_a_robot_that_loses_sight_of_another_raises_its_version():
    """So no table ever comes back, and an old digest names none that counts."""
    a, b, c = robot("a", "bc"), robot("b", "ac"), robot("c", "ab")
    agree(0.1, a, b, c)
    name, version = a.log.newest.name, a.bid[0]
    a.set_members(0.2, "b")
    a.set_members(0.3, "bc")
    assert a.bid[0] == version + 1
    assert a.log.newest.name != name
    assert a.pending


def test_who_comes_has_an_equal_part_left_before_anybody_agrees():
    """Also in the table that was agreed on, whatever is known of the newcomer meanwhile."""
    a = robot("a")
    a.settle(1.0)
    assert a.entitled == UNIT - 200
    a.set_members(1.1, "b")
    a.settle(1.1)
    assert a.entitled == (UNIT - 200) // 2


def test_who_is_back_soon_may_have_noticed_nothing():
    """It holds what it had until it agrees anew, so the other has no more than a newcomer; later it has noticed."""
    a, b = robot("a", "b"), robot("b", "a")
    agree(0.1, a, b)
    a.set_members(2.0, "")
    a.settle(2.0)
    assert a.entitled == UNIT - 200
    a.set_members(2.5, "b")
    a.settle(2.5)
    assert a.entitled == 200 // TUNING.newcomers
    agree(2.6, a, b)
    assert a.entitled + b.entitled == UNIT - 200
    a.set_members(3.0, "")
    a.settle(3.0)
    a.set_members(5.1, "b")
    a.settle(5.1)
    assert a.entitled == (UNIT - 200) // 2


def test_memory_is_bounded():
    """Of tables and of bids of robots that are gone."""
    a, b = robot("a", "b"), robot("b", "a")
    agree(0.1, a, b)
    least = a.entitled
    for i in range(30):
        a.heard(0.2, "b", SplitReport(10 + i, (Segment(300 + i, 200 if i == 3 else 100),), 1, 1))
        a.settle(0.2)
        least = min(least, a.log.newest.part)
    assert len(list(a.log)) <= TUNING.tables_kept
    assert a.entitled == least
    for i in range(2 * TUNING.bids_kept):
        a.heard(0.3, f"x{i}", SplitReport(1, BID, 1, 1))
    assert len(a._bids) <= TUNING.bids_kept


def test_a_bid_of_an_older_version_changes_nothing():
    """Nor does one of the same version: it is the same."""
    a, b = robot("a", "b"), robot("b", "a", version=7)
    agree(0.1, a, b)
    name = a.log.newest.name
    a.heard(0.2, "b", SplitReport(3, (), 1, 1))
    a.settle(0.2)
    assert a.log.newest.name == name


def test_a_newcomer_that_all_have_seen_uses_the_equal_part_that_they_leave_it():
    """Though it can agree on no table yet, as of so many bids each changed the newest one."""
    others = "bcdefghijklmn"
    a = robot("a", others)
    for number, peer in enumerate(others[:-1]):
        a.heard(0.9, peer, SplitReport(1, (Segment(9000, 200 + number),), 1, 0))
        a.settle(0.9)
    assert a.entitled == 200 // TUNING.newcomers
    a.settle(1.0)
    assert a.newcomer
    assert a.entitled == a.equal == (UNIT - 200) // (len(others) + 1)
    a.log.announced(a.log.newest.name)
    assert a.entitled == a.log.newest.total < a.equal


def test_what_was_said_of_a_table_counts_though_older_news_came_after_it():
    """And before we had that table ourselves: states come in any order."""
    one, other, third = robot("a", "bc"), robot("b", "ac"), robot("c", "ab")
    old = SplitReport(*third.bid, third.log.newest.name, 0)
    tell(0.1, one, other, third)
    tell(0.1, other, third)
    tell(0.2, third, one)
    one.heard(0.3, "c", old)
    assert not one.formed
    tell(0.3, third, other)
    tell(0.4, other, one)
    assert one.formed


def test_until_all_agree_a_robot_has_the_least_that_its_tables_give():
    """From the one agreed on before to the newest one."""
    a, b, c = robot("a", "bc"), robot("b", "ac"), robot("c", "ab")
    agree(0.1, a, b, c)
    before = a.entitled
    b.ask(0.2, (Segment(300, 120),))
    tell(0.2, b, a, c)
    assert a.log.newest.total > before
    assert (a.pending, a.entitled) == (True, before)
    tell(0.3, c, a)
    assert (a.pending, a.entitled) == (False, a.log.newest.total)


def test_a_table_counts_once_we_have_announced_that_we_have_it():
    """Before, nobody can have agreed on it."""
    a, b, c = robot("a", "bc"), robot("b", "ac"), robot("c", "ab")
    agree(0.1, a, b, c)
    before = a.entitled
    b.ask(0.2, (Segment(9000, 250),))
    tell(0.2, b, a)
    assert a.log.newest.total < before
    assert a.entitled == before
    a.log.announced(a.log.newest.name)
    assert a.entitled == a.log.newest.total
