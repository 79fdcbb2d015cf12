"""Which tables count for a robot: from the one agreed on to the newest one."""

from proxy.core.protocol.bid import Segment
from tests.proxy.core.split.agreeing import agree, robot, tell


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
    a.log.announced(0.0, a.log.newest.name)
    assert a.entitled == a.log.newest.total
