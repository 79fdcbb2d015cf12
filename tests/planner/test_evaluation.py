"""The gains of messages against the definition of the utility."""

import dataclasses
import random

import numpy as np
import pytest

from planner import Linear, Message, Problem, ProblemError, Stream, Video
from planner.definition import utility
from planner.evaluation import tabulate_gains
from tests.planner.windows import open_messages, window
from tests.seeds import seeds


def message(t_gen, *, stream=0, t_rcv=None, utility=None, scale=1.0, sent=False):
    received = t_gen if t_rcv is None else t_rcv
    return Message(stream, t_gen, t_gen, received, utility or Linear(1.0, 0.1), scale, (), sent)


def problem(*messages, t_end=10.0):
    current = next(index for index, m in enumerate(messages) if not m.sent)
    streams = tuple(Stream(robot) for robot in range(1 + max(m.stream for m in messages)))
    return Problem(streams, messages, current, (), (), -1.0, t_end)


def added_up(window_, sends):
    """U of a plan from the tabulated gains, as a search adds them."""
    gains = tabulate_gains(window_)
    state = [0] * len(window_.streams)
    total = gains.facts
    for level, index in enumerate(open_messages(window_)):
        if index in sends:
            stream = gains.stream[level]
            total += gains.gain[gains.start[level] + state[stream]]
            state[stream] = gains.after[gains.start[level] + state[stream]]
    return total


@pytest.mark.parametrize("seed", seeds(60))
def test_gains_add_up_to_the_utility(seed):
    """The facts and the gains of any plan sum to its utility by the definition, whatever lies between."""
    window_ = window(seed, robots=1 + seed % 4, horizon=10, grid=seed % 3 == 0)
    draw = random.Random(seed)
    for _ in range(5):
        sends = [index for index in open_messages(window_) if draw.random() < 0.5]
        assert added_up(window_, sends) == pytest.approx(utility(window_, sends), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", seeds(20))
def test_facts_and_everything(seed):
    """The table knows U of the facts alone and U(M) of all messages."""
    window_ = window(seed, robots=3, horizon=9)
    gains = tabulate_gains(window_)
    assert gains.facts == pytest.approx(utility(window_, []), rel=1e-9, abs=1e-12)
    assert gains.everything == pytest.approx(utility(window_, open_messages(window_)), rel=1e-9)


def test_newer_message_takes_over_at_its_receipt():
    """Of two messages the second counts from its own receipt on, the first until then."""
    two = problem(message(0.0), message(4.0, t_rcv=5.0))
    first = 5.0 - 0.1 * 5.0**2 / 2
    second = (6.0 - 0.1 * 6.0**2 / 2) - (1.0 - 0.1 * 1.0**2 / 2)
    assert utility(two, [0, 1]) == pytest.approx(first + second)
    assert utility(two, [0]) == pytest.approx(10.0 - 0.1 * 10.0**2 / 2)


def test_message_received_after_a_later_one_counts_from_then():
    """The message received last counts, even when it is the older one."""
    late = problem(message(0.0, t_rcv=5.0), message(1.0, t_rcv=2.0, sent=True))
    assert utility(late, [0]) == pytest.approx(added_up(late, [0]))
    assert utility(late, [0]) < utility(late, [])


def test_message_received_after_the_end_is_worth_nothing():
    """What arrives after the end of the window adds nothing."""
    assert added_up(problem(message(0.0, t_rcv=11.0)), [0]) == 0.0


def test_kinds_of_utility_mix():
    """Messages of different kinds of utility, even of kinds the planner does not know, share one table."""

    class Flat:
        def value(self, age):
            return np.ones_like(age)

        def integral(self, start, end):
            return end - start

    mixed = problem(
        message(0.0, utility=Flat()),
        message(1.0, utility=Video()),
        message(2.0, utility=Flat(), stream=1),
        message(3.0, scale=2.0),
        message(4.0, utility=Video(), stream=1),
    )
    for sends in ([], [0], [0, 1], [0, 2, 4], [0, 1, 2, 3, 4]):
        assert added_up(mixed, sends) == pytest.approx(utility(mixed, sends))
    assert utility(mixed, [0]) == pytest.approx(10.0)


def test_utility_that_is_not_finite_is_refused():
    """A scale that overflows is an error, not an infinite plan."""
    huge = problem(message(0.0, scale=1e308, utility=Linear(1e6, 1.0)))
    with pytest.raises(ProblemError, match="not finite"):
        tabulate_gains(huge)


def test_too_many_gains_are_refused():
    """A window whose table would not fit in memory is an error that says so."""
    many = problem(*(message(at * 1e-4) for at in range(3000)))
    with pytest.raises(ProblemError, match="gains to tabulate"):
        tabulate_gains(many)


def test_table_of_one_stream_among_many():
    """Streams without messages in the window change nothing."""
    alone = problem(message(0.0), message(1.0))
    wider = dataclasses.replace(alone, streams=(*alone.streams, Stream(7), Stream(8)))
    assert tabulate_gains(wider).gain.tolist() == tabulate_gains(alone).gain.tolist()
