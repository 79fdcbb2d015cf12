"""The last decisions on each stream: which are one, and which are forgotten."""

import pytest

from planner import Plan
from proxy.core.model.waiting import Waiting
from proxy.core.samples import decision_log
from proxy.core.samples.decision_log import DecisionLog, Searched, Why
from proxy.core.samples.tuning import TUNING
from proxy.core.view.stream import Sent
from proxy.core.window.window import WindowBuilder
from tests.proxy.core.window.views import add_stream, aggregated, make_view, union
from tests.proxy.core.window.views import sample as undecided

ROOM, FULL = Why("forwarded", "unneeded"), Why("dropped:constraint", "", ("air",))


def sample(number, key="a"):
    return Waiting(number, key, 100, float(number), 1.0, 5, markovian=True)


def test_alike_samples_in_a_row_are_one_decision():
    """It tells how many they are, from when until when, and what the last one was."""
    log = DecisionLog()
    for now in (1.0, 2.0, 3.0):
        log.note(now, "a", sample(now), ROOM)
    log.note(4.0, "a", sample(4.0), FULL)
    log.note(5.0, "a", None, Why("dropped:superseded"), count=3)
    first, second, third = log.of("a")
    assert (first.count, first.since, first.until, first.sample.sample) == (3, 1.0, 3.0, 3.0)
    assert (second.number, second.nth, second.why) == (4, 4, FULL)
    assert (third.number, third.nth, third.count) == (5, 7, 3)


@pytest.mark.parametrize(
    "other", [{"why": Why("forwarded", "owed")}, {"why": Why("forwarded", "unneeded", ("air",))}, {"to": "t"}]
)
def test_what_differs_is_another_decision(other):
    """By its cause, by what is lacking, or by whom it is for."""
    log = DecisionLog()
    log.note(1.0, "a", sample(1), ROOM)
    log.note(2.0, "a", sample(2), **({"why": ROOM} | other))
    assert len(log.of("a")) == 2


def test_each_search_is_a_decision():
    """However alike."""
    log, searched = DecisionLog(), Why("forwarded", "search", searched=object())
    log.note(1.0, "a", sample(1), searched)
    log.note(2.0, "a", sample(2), Why("forwarded", "search", searched=object()))
    assert [entry.count for entry in log.of("a")] == [1, 1]


def test_so_many_are_kept_of_a_stream():
    """The last ones."""
    log = DecisionLog()
    for now in range(2 * TUNING.entries):
        log.note(now, "a", sample(now), FULL if now % 2 else ROOM)
    kept = log.of("a")
    assert [entry.nth for entry in kept] == list(range(TUNING.entries + 1, 2 * TUNING.entries + 1))
    assert log.of("unknown") == []


def test_so_many_streams_are_kept(monkeypatch):
    """The one that is longest without anything new is forgotten."""
    small = type(TUNING)(logged_streams=2)
    monkeypatch.setattr(decision_log, "TUNING", small)
    log = DecisionLog()
    for now, key in enumerate("abac"):
        log.note(now, key, sample(now, key), FULL if now else ROOM)
    assert sorted(log) == ["a", "c"]


def test_so_many_searches_are_kept_in_all(monkeypatch):
    """Whatever streams they are of; other decisions stay."""
    monkeypatch.setattr(decision_log, "TUNING", type(TUNING)(logged_searches=2, logged_streams=3))
    log = DecisionLog()
    log.note(0.0, "a", sample(0), ROOM)
    for now, key in enumerate("abcb", start=1):
        log.note(now, key, sample(now, key), Why("forwarded", "search", searched=object()))
    assert {key: [entry.until for entry in log.of(key)] for key in "abc"} == {"a": [0.0], "b": [4], "c": [3]}
    log.note(9.0, "d", sample(9, "d"), Why("forwarded", "search", searched=object()))
    assert "a" not in log


def test_the_streams_that_matter_most_are_kept(make_specs):
    """What the plan sends comes first; of those for which there is no place it is known how many they are."""
    view, others = make_view(make_specs()), TUNING.rivals + 3
    view.subscribers.set_own(("robot/**",))
    for number in range(others + 1):
        add_stream(view, f"r{number + 1}")
    problem, _, full, candidates = WindowBuilder(view, 0.0).build(10.0, undecided(10.0), (), union())
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
    problem, _, full, candidates = WindowBuilder(view, 0.0).build(10.0, undecided(10.0), (), union())
    plan = Plan(True, (problem.current,), 1.0, None, 9, 1)
    searched = Searched.of(plan, problem, candidates, full, 300, cut=False)
    assert searched.ends == pytest.approx(ends)
