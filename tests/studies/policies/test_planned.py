"""The planner as a policy, in windows with several futures."""

from dataclasses import fields, replace

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from studies.central import Uncertain
from studies.policies import Planned


def future(rival):
    """A message that competes with one worth `rival` for the only room."""
    messages = tuple(
        Message(i, 0.1 * i, 0.1 * i, 0.1 * i + 0.01, Linear(1.0, 0.2), scale, (1.0,))
        for i, scale in enumerate((10.0, rival))
    )
    return Problem((Stream(0), Stream(1)), messages, 0, (Constraint("messages", 0.5, 1.0),), (), 0.0, 3.0, False)


def uncertain(*rivals):
    """One window with a future for each rival; what is expected is the first."""
    expected = future(rivals[0])
    values = {field.name: getattr(expected, field.name) for field in fields(expected)}
    return Uncertain(**values, futures=tuple(map(future, rivals)))


def test_the_mean_of_the_futures_decides():
    """One great rival outweighs several small ones when its loss is greater than what they leave to gain."""
    planned = Planned(SearchSettings(), 30)
    assert planned(uncertain(1.0, 1.0, 15.0))
    assert not planned(uncertain(1.0, 1.0, 100.0))


def test_what_breaks_a_constraint_is_not_sent_in_any_future():
    """A window without room is decided at once."""
    free = future(1.0)
    first, second = free.messages
    full = replace(free, messages=(first._replace(sent=True), second), current=1)
    values = {field.name: getattr(full, field.name) for field in fields(full)}
    assert not Planned(SearchSettings(), 30)(Uncertain(**values, futures=(full, full)))
