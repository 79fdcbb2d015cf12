"""What is kept of a decision by a search."""

import pytest

from planner import Plan
from proxy.core.samples.searched import Searched
from proxy.core.samples.tuning import TUNING
from proxy.core.view.stream import Sent
from proxy.core.window.window import WindowBuilder
from tests.proxy.core.window.views import add_stream, aggregated, make_view, sample, union


def test_the_streams_that_matter_most_are_kept(make_specs):
    """What the plan sends comes first; of those for which there is no place it is known how many they are."""
    view, others = make_view(make_specs()), TUNING.rivals + 3
    view.subscribers.set_own(("robot/**",))
    for number in range(others + 1):
        add_stream(view, f"r{number + 1}")
    problem, full, candidates = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    current = problem.messages[problem.current].stream
    last = max(place for place, each in enumerate(problem.messages) if not each.sent and each.stream != current)
    searched = Searched.of(Plan(False, (last,), 1.0, None, 9, 1), problem, candidates, full, 300, cut=True)
    sent, *rest = searched.rivals
    assert (sent.robot, sent.sent) == (candidates[problem.messages[last].stream].stream.robot, 1)
    assert not any(rival.sent for rival in rest)
    assert (len(searched.rivals), searched.more) == (TUNING.rivals, 3)
    assert (searched.this.robot, searched.asked, searched.cut, searched.full) == ("r1", 300, True, full)
    assert searched.held == sum(not each.sent for each in problem.messages) - 1


@pytest.mark.parametrize(("aggregation", "ends"), [('"most_recent"', 0.0), ('"current"', 4.0)])
def test_what_a_sample_ends_is_kept(make_specs, aggregation, ends):
    """What was sent last is worth 5, and nothing is left of it but 1."""
    view, stream = aggregated(make_specs, aggregation)
    stream.note_sent(1, Sent(9.9, 9.9, 1000, 5.0, {"red": 1.0}))
    problem, full, candidates = WindowBuilder(view, 0.0).build(10.0, sample(10.0), (), union())
    plan = Plan(True, (problem.current,), 1.0, None, 9, 1)
    searched = Searched.of(plan, problem, candidates, full, 300, cut=False)
    assert searched.ends == pytest.approx(ends)
