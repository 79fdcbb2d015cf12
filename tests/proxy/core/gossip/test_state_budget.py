"""What states, questions and answers may take."""

import pytest

from proxy.core.gossip.state_budget import StateBudget
from proxy.core.gossip.tuning import TUNING


@pytest.fixture
def budget():
    """Of ten robots that may tell each other 1,000 B/s, with nothing saved."""
    made = StateBudget(0.0)
    made.set_rate(1000.0, 10)
    return made


def test_what_went_out_is_paid_for_in_time(budget):
    """With the part for states of the part of this robot; what is more than may be saved is lost."""
    assert budget.paid_in == 0.0
    budget.owe(500 - TUNING.overhead, 2)
    assert budget.paid_in == pytest.approx(1000.0 / (TUNING.states * 100.0))
    assert budget.takes(500 - TUNING.overhead, 2) == budget.paid_in
    budget.gain(5.0)
    assert budget.paid_in == pytest.approx(1000.0 / (TUNING.states * 100.0) - 5.0)
    budget.gain(1000.0)
    saved = TUNING.state_savings * TUNING.states * 100.0
    budget.owe(round(saved) - TUNING.overhead, 1)
    assert budget.paid_in == 0.0


def test_questions_of_all_robots_take_the_whole_allowance(budget):
    """Each with its answer."""
    assert budget.question_takes() == pytest.approx(10 * (TUNING.question + TUNING.answer) / 1000.0)
