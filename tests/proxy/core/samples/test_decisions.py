"""Statistics of decisions."""

from hypothesis import given
from hypothesis import strategies as st

from planner import Plan
from proxy.core.samples.decision_log import Searched
from proxy.core.samples.decisions import Decisions


def note(decisions, plan):
    searched = Searched(plan, ("air", "air (held)"), None, (), 0, 10, cut=False, held=3, full=3)
    decisions.note(1.0, "robot/r1/camera", "forwarded", searched)


def plan(*, send=True, utility=2.0, gap=0.0, seconds=0.002, binding=()):
    return Plan(send, (), utility, 1.5, 10, 20, 0.5, gap, (0.25, 0.0), binding, seconds)


def test_the_last_decision_is_explained():
    """Everything that the plan says, and what became of the sample."""
    decisions = Decisions()
    assert decisions.described(0.0)["last"] is None
    note(decisions, plan(binding=("air",)))
    assert decisions.described(3.0)["last"] == {
        "age": 2.0,
        "key": "robot/r1/camera",
        "send": True,
        "reason": "forwarded",
        "utility": 2.0,
        "opposite": 1.5,
        "lead": 0.5,
        "gap": 0.0,
        "iterations": 10,
        "nodes": 20,
        "seconds": 0.002,
        "binding": ["air"],
        "prices": {"air": 0.25, "air (held)": 0.0},
    }


def test_a_plan_is_proven_when_its_gap_is_rounding():
    """Against what it is worth, or against one; an unknown gap proves nothing and is not summed."""
    decisions = Decisions()
    for gap, utility in ((0.0, 5.0), (1e-7, 1e3), (5e-10, 0.0), (1e-7, 1.0), (None, 7.0)):
        note(decisions, plan(gap=gap, utility=utility))
    status = decisions.described(2.0)
    assert (status["made"], status["bounded"], status["proven"]) == (5, 4, 3)
    assert status["utility"] == 1006.0


def test_what_bound_is_counted_for_what_was_dropped():
    """By the plan or for want of room, the most frequent first; what is sent does not count."""
    decisions = Decisions()
    note(decisions, plan(send=True, binding=("energy",)))
    note(decisions, plan(send=False, binding=("air", "energy")))
    decisions.refused(("air",))
    assert list(decisions.described(2.0)["binding"].items()) == [("air", 2), ("energy", 1)]


PLANS = st.builds(
    plan,
    send=st.booleans(),
    utility=st.floats(0, 10),
    gap=st.none() | st.floats(0, 10),
    seconds=st.none() | st.floats(0, 1),
)


@given(st.lists(PLANS, max_size=20))
def test_the_sums_are_those_of_the_plans(plans):
    """Whatever is unknown counts as nothing."""
    decisions = Decisions()
    for each in plans:
        note(decisions, each)
    status = decisions.described(2.0)
    assert (status["made"], status["iterations"]) == (len(plans), 10 * len(plans))
    assert status["seconds"] == sum(each.seconds or 0.0 for each in plans)
    assert status["longest"] == max((each.seconds or 0.0 for each in plans), default=0.0)
    assert status["gap"] == sum(each.gap or 0.0 for each in plans)
    assert status["proven"] <= status["bounded"] <= status["made"]
