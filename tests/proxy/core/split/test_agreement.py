"""Which tables count for a robot."""

from proxy.core.protocol.bid import UNIT, Segment
from proxy.core.split.agreement import Agreement
from proxy.core.split.proposal import indifferent
from proxy.core.split.tuning import TUNING

BID = (Segment(4000, 120),)


def robot(own, others="", version=0):
    agreement = Agreement(own, 0.0, floor=200, settled_at=1.0, kind=b"", version=version)
    agreement.set_members(0.0, set(others))
    agreement.ask(0.0, BID)
    return agreement


def tell(now, sender, *receivers):
    names = sender.log.newest.name, 0 if sender.newcomer else sender.log.agreed.name
    version, bid = sender.bid
    for receiver in receivers:
        receiver.heard(now, sender.own, version, bid, names)
        receiver.settle(now)


def agree(now, *robots):
    for _ in range(3):
        for sender in robots:
            tell(now, sender, *[r for r in robots if r is not sender])


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
    assert (a.settled, a.known, a.entitled + b.entitled) == (True, True, UNIT - 200)


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


def test_memory_is_bounded():
    """Of tables and of bids of robots that are gone."""
    a, b = robot("a", "b"), robot("b", "a")
    agree(0.1, a, b)
    least = a.entitled
    for i in range(30):
        a.heard(0.2, "b", 10 + i, (Segment(300 + i, 200 if i == 3 else 100),), (1, 1))
        a.settle(0.2)
        least = min(least, a.log.newest.part)
    assert len(list(a.log)) <= TUNING.tables_kept
    assert a.entitled == least
    for i in range(2 * TUNING.bids_kept):
        a.heard(0.3, f"x{i}", 1, BID, (1, 1))
    assert len(a._bids) <= TUNING.bids_kept


def test_a_bid_of_an_older_version_changes_nothing():
    """Nor does one of the same version: it is the same."""
    a, b = robot("a", "b"), robot("b", "a", version=7)
    agree(0.1, a, b)
    name = a.log.newest.name
    a.heard(0.2, "b", 3, (), (1, 1))
    a.settle(0.2)
    assert a.log.newest.name == name


def test_a_table_counts_once_we_have_told_that_we_have_it():
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


def test_a_newcomer_that_all_have_seen_uses_the_equal_part_that_they_leave_it():
    """Though it can agree on no table yet, as of so many bids each changed the newest one."""
    others = "bcdefghijklmn"
    a = robot("a", others)
    for number, peer in enumerate(others[:-1]):
        a.heard(0.9, peer, 1, (Segment(9000, 200 + number),), (1, 0))
        a.settle(0.9)
    assert a.entitled == 200 // TUNING.newcomers
    a.settle(1.0)
    assert a.newcomer
    assert a.entitled == a.equal == (UNIT - 200) // (len(others) + 1)
    a.log.announced(a.log.newest.name)
    assert a.entitled == a.log.newest.total < a.equal


def test_all_agree_on_other_slots_where_that_is_worth_it():
    """Who may use a slot longer gains little more than the other loses, unless its messages are worth far more."""

    def frames(level):
        return tuple(Segment(6000, level - less, quarters) for less, quarters in ((0, 1), (2, 1), (4, 2)))

    a, b = robot("a", "b"), robot("b", "a")
    for each in (a, b):
        each.ask(0.0, frames(100))
    agree(0.1, a, b)
    assert not a.pending
    for level, ring in ((97, {"a": 1, "b": 3}), (103, {"a": 3, "b": 1})):
        assert dict(a.log.newest.allocated({"a": frames(level), "b": frames(100)}).slots[0].ring) == ring
        assert indifferent(a, frames(level))
    assert not indifferent(a, frames(110))


def test_a_larger_message_is_asked_for_though_all_together_gain_little():
    """And divisible room, whose worth is not known as well, is never left to slots."""
    robots = [robot(tag, "abcdefghij".replace(tag, "")) for tag in "abcdefghij"]
    for each in robots:
        each.ask(0.0, (Segment(900, 100, 4),))
    agree(0.1, *robots)
    first, second, *_ = robots
    larger = (Segment(1300, 94, 4),)
    bids = {each.own: each.bid[1] for each in robots} | {first.own: larger}
    assert first.log.newest.allocated(bids).worth(bids) < (1.0 + TUNING.slot_gain) * first.log.newest.allocation.worth(
        bids
    )
    assert not indifferent(first, larger)
    for each in robots:
        each.ask(0.2, (Segment(2000, 100, 4),))
    agree(0.3, *robots)
    assert indifferent(first, (Segment(2000, 97, 4),))
    second.ask(0.4, (Segment(900, 100),))
    agree(0.5, *robots)
    assert not indifferent(first, (Segment(2000, 97, 4),))
