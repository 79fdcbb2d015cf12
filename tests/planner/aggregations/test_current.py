"""`current`: what a receiver is shown counts, less what it shows too much while something of less worth is newest."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import (
    Aggregation,
    Constraint,
    Latest,
    Linear,
    Message,
    Power,
    Problem,
    ProblemError,
    Receiver,
    SearchSettings,
    Step,
    Stream,
    start,
)
from planner.constraints import violations
from planner.definition import utility
from planner.numpy_tables import tabulate_with_numpy
from planner.tables import tabulate
from tests.planner.windows import objectives, open_messages, optimum, utilities, window
from tests.seeds import seeds

CURRENT = (Aggregation.CURRENT,)
CONSTANT = Step(1.0, 100.0)
"""What is worth its scale a second, as long as it is shown."""


def message(t_gen, scale, *, latency=0.0, sent=False, worth=CONSTANT):
    return Message(0, t_gen, t_gen, t_gen + latency, worth, scale, (1.0,), sent)


def problem(*messages, t_end=10.0, stream=Stream(0, Aggregation.CURRENT), limit=100.0, goes_on=False):  # noqa: B008 - frozen
    current = next(at for at, each in enumerate(messages) if not each.sent)
    return Problem((stream,), messages, current, (Constraint("c", 1.0, limit),), (), -1.0, t_end, goes_on)


def test_the_end_of_an_event_is_lost_until_it_is_sent():
    """Something of scale 11 is shown from 0 on, and is over at 4: each second that it is still shown loses 10."""
    ends = problem(message(0.0, 11.0, sent=True), message(4.0, 1.0))
    assert utility(ends, ()) == pytest.approx(11 * 10 - 10 * 6)
    assert utility(ends, (1,)) == pytest.approx(11 * 4 + 1 * 6)


def test_an_event_that_begins_gains_as_it_does_with_most_recent():
    """Nothing is lost where too little is shown."""
    begins = problem(message(0.0, 1.0, sent=True), message(4.0, 11.0))
    recent = replace(begins, streams=(Stream(0),))
    for sends in ((), (1,)):
        assert utility(begins, sends) == utility(recent, sends)


def test_most_recent_keeps_what_is_no_longer_so_and_current_does_not():
    """The old frame full of red is worth more than a fresh plain one, but it is not true."""
    worth = Linear(1.0, 0.1)
    ends = problem(message(0.0, 11.0, sent=True, worth=worth), message(1.0, 1.0, worth=worth), t_end=2.0)
    for kind, sent in ((Aggregation.MOST_RECENT, False), (Aggregation.CURRENT, True)):
        search = start(replace(ends, streams=(Stream(0, kind),)), SearchSettings())
        search.run(300)
        assert search.plan().send is sent


def test_what_was_dropped_before_counts_too():
    """The newest sample need not be a message: the stream tells when it was generated, and its scale."""
    shown, plain = message(0.0, 11.0, sent=True), message(8.0, 11.0)
    untold = problem(shown, plain)
    told = replace(untold, streams=(Stream(0, Aggregation.CURRENT, newest=Latest(3.0, 1.0)),))
    assert utility(untold, ()) - utility(told, ()) == pytest.approx(10 * 5)
    assert utility(untold, (1,)) - utility(told, (1,)) == pytest.approx(10 * 5)


def test_nothing_received_yet_loses_nothing():
    """Whatever is generated meanwhile."""
    assert utility(problem(message(0.0, 11.0), message(4.0, 1.0)), ()) == 0.0


def test_a_receiver_loses_when_it_is_shown_and_by_its_share():
    """What arrives 2 s later is wrong 2 s longer, for each of two."""
    stream = Stream(0, Aggregation.CURRENT, (Receiver(2.0, 2.0),))
    ends = problem(message(0.0, 11.0, sent=True), message(4.0, 1.0), stream=stream)
    assert utility(ends, (1,)) == pytest.approx(2 * (11 * 4 - 10 * 2 + 1 * 4))


@pytest.mark.parametrize("mode", ["best", "paper"])
@pytest.mark.parametrize("engine", ["native", "python"])
def test_a_plan_may_be_worth_less_than_nothing(mode, engine):
    """Both modes answer with the plan that loses least."""
    shown = message(0.0, 11.0, sent=True, worth=Step(1.0, 0.5))
    over = problem(shown, message(4.0, 0.0), message(4.1, 0.0), limit=1.0)
    search = start(over, SearchSettings(search=mode, engine=engine))
    search.run(300)
    plan = search.plan()
    assert plan.sends == (1,)
    assert plan.utility == pytest.approx(11 * 0.5)
    late = replace(over, messages=(*over.messages[:1], *(m._replace(t_rcv=m.t_rcv + 1.0) for m in over.messages[1:])))
    search = start(late, SearchSettings(search=mode, engine=engine))
    search.run(300)
    assert search.plan().sends == (1,)
    assert search.plan().utility == pytest.approx(11 * 0.5 - 11 * 1.0)


def test_a_utility_without_a_limit_is_refused():
    """What is lost could not be told; either table says so."""
    bad = problem(message(0.0, 1.0, sent=True), message(1.0, 1.0, worth=Power(0.5)))
    with pytest.raises(ProblemError, match="message 1: its utility has no limit at the age 0: `current` needs one"):
        tabulate(bad)


@pytest.mark.parametrize(
    ("newest", "says"),
    [
        (Latest(float("nan"), 1.0), "stream 0: newest must be a finite time and a scale >= 0, not nan, 1.0"),
        (Latest(0.0, -1.0), "stream 0: newest must be a finite time and a scale >= 0, not 0.0, -1.0"),
        ((0.0,), r"stream 0: newest must be a time and a scale, or None, not \(0.0,\)"),
        (Latest("now", 1.0), "stream 0: newest must be a number, not 'now'"),
    ],
)
def test_a_newest_sample_without_meaning_is_refused(newest, says):
    """With its stream."""
    with pytest.raises(ProblemError, match=says):
        tabulate(problem(message(0.0, 1.0), stream=Stream(0, Aggregation.CURRENT, newest=newest)))


@given(st.integers(0, 2**32), st.sampled_from(("native", "python")), st.booleans())
def test_best_mode_finds_the_optimum_of_all_subsets(seed, engine, goes_on):
    """On any window, of one receiver or several; of its objective where the mission goes on."""
    drawn = window(
        seed, robots=1 + seed % 3, horizon=6, constraints=seed % 3, goes_on=goes_on, aggregations=CURRENT * 2
    )
    search = start(drawn, SearchSettings(engine=engine))
    search.run(5000)
    assert search.done
    values = objectives if goes_on else utilities
    assert values(drawn)(search.plan().sends) == pytest.approx(optimum(drawn, values)[0], rel=1e-8, abs=1e-8)
    assert search.plan().gap == 0.0


@given(st.integers(0, 2**32), st.booleans())
def test_no_plan_exceeds_the_bound_of_a_short_search(seed, goes_on):
    """Values below nothing make no bound wrong."""
    drawn = window(seed, robots=2, horizon=7, constraints=1 + seed % 2, goes_on=goes_on, aggregations=CURRENT * 2)
    values = objectives if goes_on else utilities
    value, best = values(drawn), optimum(drawn, values)[0]
    for iterations in (1, 3, 20, 110, 130):
        search = start(drawn, SearchSettings())
        search.run(iterations)
        plan = search.plan()
        if plan.gap is not None:
            assert value(plan.sends) + plan.gap >= best - 1e-8 * max(1.0, abs(best))


@given(st.integers(0, 2**32), st.sampled_from(("off", "paper", "exact")))
def test_paper_mode_comes_to_the_optimum(seed, reduction):
    """Whatever the reduction: nodes of the same last messages and windows are tantamount. It reaches the best there is
    once its tree holds all plans; Eq. 7 alone may cut what has more room left."""
    drawn = window(seed, robots=2, horizon=5, constraints=seed % 2, goes_on=False, aggregations=CURRENT * 2)
    search = start(drawn, SearchSettings(search="paper", reduction=reduction))
    search.run(4000)
    plan = search.plan()
    assert not violations(drawn, plan.sends)
    assert plan.utility == pytest.approx(utility(drawn, plan.sends), rel=1e-9, abs=1e-9)
    assert plan.utility <= optimum(drawn)[0] + 1e-9


@given(st.integers(0, 2**32))
def test_equal_scales_are_most_recent(seed):
    """To the last bit of either table."""
    drawn = window(seed, robots=2, horizon=8, aggregations=CURRENT * 2)
    alike = replace(
        drawn,
        messages=tuple(m._replace(scale=2.0) for m in drawn.messages),
        streams=tuple(s._replace(newest=None) for s in drawn.streams),
    )
    recent = replace(alike, streams=tuple(s._replace(aggregation=Aggregation.MOST_RECENT) for s in alike.streams))
    for make in (tabulate, tabulate_with_numpy):
        one, other = make(alike, beyond=True), make(recent, beyond=True)
        assert one.gains.aim.tolist() == other.gains.aim.tolist()
        assert one.gains.markovian.tolist() == other.gains.markovian.tolist()


@pytest.mark.parametrize("seed", seeds(30))
def test_states_of_eq_7_are_the_last_messages(seed):
    """What the last message sent is says all that further gains depend on, whatever was sent before it."""
    drawn = window(seed, robots=1, horizon=7, aggregations=CURRENT * 2)
    opened = open_messages(drawn)
    last, coming = opened[3], opened[4:]
    for extra in ([], [opened[0]], [opened[1], opened[2]]):
        more = [utility(drawn, [*extra, last, *coming[:k]]) for k in (1, 2)]
        none = utility(drawn, [*extra, last])
        bare = utility(drawn, [last])
        bare_more = [utility(drawn, [last, *coming[:k]]) for k in (1, 2)]
        assert [m - none for m in more] == pytest.approx([m - bare for m in bare_more], abs=1e-9)
