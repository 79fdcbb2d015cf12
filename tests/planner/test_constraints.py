"""Sliding windows: tabulated checks against the definition."""

import itertools

import pytest

from planner import Constraint, Linear, Message, Problem, Stream, Traffic
from planner.constraints import tabulate_checks, violations
from planner.python_engine.path import Path
from planner.tables import tabulate
from tests.planner.windows import open_messages, window
from tests.seeds import seeds


def message(t_sent, *use, sent=False):
    return Message(0, t_sent, t_sent, t_sent, Linear(1.0, 1.0), 1.0, tuple(map(float, use)), sent)


def problem(messages, constraints, traffic=()):
    current = next(index for index, m in enumerate(messages) if not m.sent)
    return Problem((Stream(0),), tuple(messages), current, tuple(constraints), tuple(traffic), -9.0, 9.0)


def fitting(window_, sends):
    """Whether every send of a plan passes its checks, one after the other."""
    path = Path(tabulate(window_))
    for level, index in enumerate(open_messages(window_)):
        if index in sends and not path.fits(level):
            return False
        path.step(level, send=index in sends)
    return True


@pytest.mark.parametrize("seed", seeds(30))
def test_checks_agree_with_the_definition(seed):
    """A plan passes all checks exactly when no window of the definition is overfull, for every subset."""
    window_ = window(seed, robots=3, horizon=7, constraints=1 + seed % 3, grid=seed % 2 == 0)
    opened = open_messages(window_)
    for chosen in itertools.product((False, True), repeat=len(opened)):
        sends = list(itertools.compress(opened, chosen))
        assert fitting(window_, sends) == (not violations(window_, sends))


def test_rows_hold_for_every_plan_that_fits():
    """What the tabulated rows say about any plan is true of all plans that keep the constraints."""
    for seed in range(30):
        window_ = window(seed, robots=3, horizon=7, constraints=2, grid=seed % 2 == 0)
        checks, opened = tabulate_checks(window_), open_messages(window_)
        for chosen in itertools.product((False, True), repeat=len(opened)):
            if violations(window_, list(itertools.compress(opened, chosen))):
                continue
            share = checks.share * [[send] for send in chosen]
            for r, of in enumerate(checks.rows.of):
                within = share[checks.rows.first[r] : checks.rows.last[r] + 1, of].sum()
                assert within <= checks.rows.capacity[r] + 1e-9
            assert not any(never and send for never, send in zip(checks.never, chosen, strict=True))


def test_window_is_closed():
    """Messages exactly a window apart count together, also when rounding would say otherwise."""
    two = problem([message(0.3, 1), message(0.8, 1)], [Constraint("c", 0.5, 1.0)])
    assert not fitting(two, [0, 1])
    assert fitting(two, [1])
    later = problem([message(0.3, 1), message(0.81, 1)], [Constraint("c", 0.5, 1.0)])
    assert fitting(later, [0, 1])


def test_facts_and_traffic_are_counted():
    """What was sent before, by whom ever, leaves less room."""
    limit = [Constraint("c", 1.0, 3.0)]
    assert fitting(problem([message(0.0, 1, sent=True), message(0.5, 2)], limit), [1])
    assert not fitting(problem([message(0.0, 2, sent=True), message(0.5, 2)], limit), [1])
    assert not fitting(problem([message(0.5, 2)], limit, [Traffic(0.2, (2.0,))]), [0])
    assert fitting(problem([message(0.5, 2)], limit, [Traffic(-0.6, (2.0,))]), [0])


def test_message_sent_before_a_fact_is_checked_at_the_fact():
    """An older message of unknown fate must also fit into the window that ends with a later fact."""
    limit = [Constraint("c", 1.0, 2.0)]
    assert not fitting(problem([message(0.0, 1), message(0.9, 2, sent=True)], limit), [0])
    assert fitting(problem([message(0.0, 1), message(0.9, 1, sent=True)], limit), [0])


def test_overfull_facts_do_not_blame_the_plan():
    """Windows that facts alone overfill are no violation of a plan outside of them, but nothing joins them."""
    overfull = problem([message(0.0, 5, sent=True), message(0.5, 1), message(2.0, 1)], [Constraint("c", 1.0, 2.0)])
    assert violations(overfull, []) == []
    assert violations(overfull, [2]) == []
    assert violations(overfull, [1]) != []


def test_oversized_message_needs_a_stretched_window_of_its_own():
    """A message over the limit may be sent when nothing was sent within the window stretched to its size."""
    limit = [Constraint("c", 1.0, 2.0)]
    assert fitting(problem([message(0.0, 1), message(2.1, 4)], limit), [0, 1])
    assert not fitting(problem([message(0.0, 1), message(1.9, 4)], limit), [0, 1])
    assert not fitting(problem([message(0.0, 4), message(0.9, 1)], limit), [0, 1])
    assert fitting(problem([message(0.0, 4), message(1.1, 1)], limit), [0, 1])


def test_rows_exclude_what_cannot_be_sent_beside_an_oversized_message():
    """Either it is sent, or any of those in its stretched window and in the window after it."""
    times = (0.0, 0.5, 1.5, 2.4, 3.4, 3.6)
    checks = tabulate_checks(problem([message(t, 4 if t == 2.4 else 1) for t in times], [Constraint("c", 1.0, 2.0)]))
    ((of, first, last, capacity),) = [
        row for row in zip(*(getattr(checks.rows, name) for name in checks.rows.__slots__), strict=True) if row[0]
    ]
    assert (checks.constraint[of], first, last, capacity) == (0, 1, 4, 3.0)
    assert checks.share[:, of].tolist() == [0.0, 1.0, 1.0, 3.0, 1.0, 0.0]


@pytest.mark.parametrize("times", [100.0, 0.0])
def test_messages_that_could_never_be_sent_exclude_nothing(times):
    """One that takes the channel for far longer than a window, or has no other beside it."""
    large = message(0.5, 2 * times + 4)
    checks = tabulate_checks(problem([message(0.0, 1), large] if times else [large], [Constraint("c", 1.0, 2.0)]))
    assert checks.use.shape == checks.share.shape == (1 + bool(times), 1)


def test_message_that_uses_nothing_always_fits():
    """A constraint that a message does not concern cannot stop it, however full it is."""
    full = problem(
        [message(0.0, 2, 0, sent=True), message(0.1, 0, 1)], [Constraint("a", 1.0, 1.0), Constraint("b", 1.0, 1.0)]
    )
    assert fitting(full, [1])


def test_limit_of_zero_lets_nothing_pass():
    """With nothing left of a constraint only messages that do not use it are sent."""
    none = problem([message(0.0, 1), message(0.1, 0)], [Constraint("c", 1.0, 0.0)])
    assert not fitting(none, [0])
    assert fitting(none, [1])
    assert violations(none, [0]) != []


def test_no_constraints():
    """Without constraints every plan fits."""
    free = problem([message(0.0), message(0.1)], [])
    assert fitting(free, [0, 1])
