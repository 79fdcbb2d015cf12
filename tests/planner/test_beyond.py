"""What a plan leaves behind at the end of its window, against the steady state worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from planner import Constraint, Linear, Message, Problem, ProblemError, Stream, Video
from planner.beyond import look_beyond
from planner.tables import tabulate
from tests.planner.windows import objective, open_messages, window
from tests.seeds import seeds


def alike(limits, *, streams=4, period=0.1, slope=0.1, scale=1.0, seconds=4.0, latency=0.0, uses=None):
    """Streams that are alike, one message each every `period` seconds."""
    times = [(round(k * period, 9), stream) for k in range(int(seconds / period)) for stream in range(streams)]
    use = uses or (1.0,) * len(limits)
    messages = tuple(Message(s, t, t, t + latency, Linear(1.0, slope), scale, use) for t, s in times)
    return Problem(tuple(map(Stream, range(streams))), messages, 0, limits, (), -1.0, seconds + 1.0)


def test_price_is_that_of_the_last_message_the_channel_carries():
    """Streams that each send every D seconds pay slope · D² / 2 for it, and earn what is left."""
    for interval in (0.9, 1.8, 2.8):
        problem = alike((Constraint("c", 2.0, 8.0 / interval),))
        beyond = look_beyond(problem)
        assert beyond.price[0] == pytest.approx(0.1 * interval**2 / 2, rel=0.05)
        net = (interval - 0.1 * interval**2 / 2 - beyond.price[0]) / interval
        assert beyond.rent == pytest.approx(np.full(4, net), rel=0.05)


def test_price_grows_as_the_limit_shrinks():
    """The less the channel carries, the more is paid for it, at most what a lone message is worth."""
    prices = [look_beyond(alike((Constraint("c", 1.0, limit),))).price[0] for limit in (50, 30, 20, 10, 5, 2, 1, 0.1)]
    assert prices[0] == 0.0
    assert prices == sorted(prices)
    assert prices[-1] <= 5.0 + 1e-9


def test_charge_falls_with_what_a_message_still_occupies():
    """The last message pays the whole price, one that is a window old nothing, in between in proportion."""
    problem = alike((Constraint("c", 2.0, 5.0),))
    beyond = look_beyond(problem)
    t_last = problem.messages[-1].t_sent
    left = [min(1.0, max(0.0, m.t_sent + 2.0 - t_last) / 2.0) for m in problem.messages]
    assert beyond.charge == pytest.approx(beyond.price[0] * np.array(left))
    assert beyond.charge[0] == 0.0


def test_oversized_message_is_charged_for_its_stretched_window():
    """A message of three limits occupies the whole channel for three windows."""
    problem = alike((Constraint("c", 1.0, 10.0),))
    heavy = problem.messages[80]._replace(use=(30.0,))
    problem = replace(problem, messages=(*problem.messages[:80], heavy, *problem.messages[81:]))
    beyond = look_beyond(problem)
    left = heavy.t_sent + 3.0 - problem.messages[-1].t_sent
    assert left > 0
    assert beyond.charge[80] == pytest.approx(beyond.price[0] * 10.0 * left)


def test_last_message_is_worth_what_it_earns_until_it_pays_to_replace_it():
    """Beyond the window it earns its utility less the rent, in place of its utility up to t_end."""
    problem = alike((Constraint("c", 2.0, 10.0),), slope=0.3)
    beyond = look_beyond(problem)
    t_c, rent = problem.messages[-1].t_rcv, beyond.rent[0]
    soonest = 0.1
    for at in (-1, -20, -60):
        m = problem.messages[at]
        ages = t_c - m.t_gen + np.linspace(0.0, 5.0, 50_001)
        utility = np.maximum(0.0, 1.0 - 0.3 * ages)
        earned = np.concatenate(([0.0], np.cumsum((utility[1:] + utility[:-1]) / 2 * 1e-4)))
        x = np.linspace(0.0, 5.0, 50_001)
        best = (earned - rent * (x - soonest))[x >= soonest - 1e-9].max()
        to_the_end = m.utility.integral(np.array([t_c - m.t_gen]), np.array([problem.t_end - m.t_gen]))[0]
        assert beyond.worth[at] == pytest.approx(best - to_the_end, abs=0.02)


def test_nothing_is_charged_where_everything_fits():
    """A channel that is never used up has no price."""
    beyond = look_beyond(alike((Constraint("c", 1.0, 1000.0),)))
    assert not beyond.price.any()
    assert not beyond.charge.any()


def test_nothing_is_left_behind_at_the_end_of_a_mission():
    """Then the search maximises U of the window, as it is."""
    problem = replace(window(3, robots=3, horizon=8), goes_on=False)
    tables = tabulate(problem, beyond=True)
    assert (tables.gains.aim == tables.gains.gain).all()
    assert tables.gains.aim_facts == tables.gains.facts


def test_equal_constraints_are_charged_once():
    """Two limits that say the same cost what one of them costs."""
    limit = Constraint("c", 2.0, 5.0)
    once, twice = look_beyond(alike((limit,))), look_beyond(alike((limit, limit)))
    assert twice.charge == pytest.approx(once.charge)
    assert twice.rent == pytest.approx(once.rent)


def test_constraint_that_concerns_no_message_is_free():
    """It may even allow nothing."""
    limits = (Constraint("mine", 2.0, 5.0), Constraint("others", 2.0, 0.0))
    beyond = look_beyond(alike(limits, uses=(1.0, 0.0)))
    assert beyond.price[1] == 0.0
    assert beyond.charge == pytest.approx(look_beyond(alike(limits[:1])).charge)


@pytest.mark.parametrize("seed", seeds(60))
def test_gains_add_up_to_the_objective(seed):
    """Whatever is sent: U, what the last messages are worth, less what is charged."""
    problem = window(seed, robots=1 + seed % 4, horizon=9, constraints=seed % 3, grid=seed % 2 == 0)
    tables = tabulate(problem, beyond=True)
    gains, opened = tables.gains, open_messages(problem)
    for number in (0, 1, 2**9 - 1, 0b101010101, 0b110001100):
        levels = [level for level in range(9) if number >> level & 1 and level < len(opened)]
        state, total = [0] * tables.streams, tables.gains.aim_facts
        for level in levels:
            total += tables.gains.aim[gains.start[level] + state[gains.stream[level]]]
            state[gains.stream[level]] = gains.after[gains.start[level] + state[gains.stream[level]]]
        assert total == pytest.approx(objective(problem, [opened[level] for level in levels]), abs=1e-9)


def test_numbers_that_overflow_are_refused():
    """What is finite in the window may not be beyond it."""
    problem = alike((Constraint("c", 2.0, 1.0),), streams=1, seconds=0.2)
    huge = tuple(m._replace(scale=1.5e308, utility=Video(a0=1.0, a1=1e4)) for m in problem.messages)
    with pytest.raises(ProblemError, match="not finite"):
        tabulate(replace(problem, messages=huge, t_end=0.2), beyond=True)
