"""What waits for the core, and in which order it is taken."""

import math

from proxy.agenda import Agenda, Nothing
from proxy.core.interface.events import TimePassed
from proxy.tuning import TUNING


def events(count, first=0):
    return [TimePassed(float(first + number)) for number in range(count)]


def taken(agenda, now=0.0):
    """Take all that is to be done now."""
    found = []
    while not isinstance(item := agenda.take(now), Nothing):
        found.append(item)
    return found


def test_some_of_what_came_meanwhile_goes_between_what_follows():
    """Each in its own order: a sample waits for one decision and not for a chain of them."""
    agenda, follows, comes = Agenda(), events(3), events(2 * TUNING.between + 1, 10)
    for event in comes:
        agenda.put(event)
    agenda.following.extend(follows)
    n = TUNING.between
    assert taken(agenda) == [*comes[:n], follows[0], *comes[n : 2 * n], follows[1], *comes[2 * n :], follows[2]]


def test_what_was_noted_is_overtaken_by_nothing_that_goes_between():
    """A later digest of its robot may be that: the earlier one would count as a replay."""
    agenda, (follows, noted, later) = Agenda(), events(3)
    agenda.following.append(follows)
    agenda.noted.append(noted)
    agenda.put(later)
    assert taken(agenda) == [noted, later, follows]


def test_what_follows_is_done_before_the_end():
    """It belongs to what was done before."""
    agenda, (last, follows) = Agenda(), events(2)
    agenda.put(last)
    agenda.put(None)
    agenda.following.append(follows)
    assert taken(agenda) == [last, follows]
    agenda.put(None)
    assert agenda.take(0.0) is Nothing.EVER


def test_orders_and_what_is_due_come_before_all_else():
    """What has a time is taken then, whoever named it."""
    agenda, (due, later, follows, noted) = Agenda(), events(4)
    agenda.following.append(follows)
    agenda.noted.append(noted)
    agenda.put_at(2.0, later)
    agenda.at(0.0, due)
    agenda.orders.append(order := lambda: None)
    assert taken(agenda) == [order, due, noted, follows]
    assert (agenda.due(), agenda.take(1.0)) == (2.0, Nothing.YET)
    assert agenda.take(2.0) is later
    assert agenda.due() == math.inf
