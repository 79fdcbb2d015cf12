"""Decisions under a deadline."""

import dataclasses
import queue
import threading
from asyncio import CancelledError

import pytest

from planner import Aggregation, Constraint, Message, Problem, SearchSettings, Stream, Video
from proxy import clock
from proxy.core.interface.commands import Decide
from proxy.worker import Decision, Worker
from tests.waiting import wait_until

FOREVER = 10.0


def decide(command, settings, deadline):
    """Make a decision to its end."""
    return Decision(command, settings, deadline).work()


def ordered(command, ticket=7):
    """Return the decision that a command with this ticket asks for."""
    return Decision(dataclasses.replace(command, ticket=ticket), SearchSettings(), FOREVER)


@pytest.fixture
def command():
    messages = tuple(
        Message(
            stream=0, t_gen=0.1 * i, t_sent=0.1 * i, t_rcv=0.1 * i + 0.01, utility=Video(), scale=1.0, use=(1000.0,)
        )
        for i in range(30)
    )
    limit = Constraint("throughput", 0.5, 2500.0)
    problem = Problem((Stream(0, Aggregation.MOST_RECENT),), messages, 0, (limit,), (), 0.0, 3.0)
    return Decide(7, problem, 1, 200, clock.monotonic())


@pytest.mark.parametrize("engine", ["native", "python"])
def test_the_iterations_asked_for_are_the_most_that_run(command, engine):
    """With time enough the search ends by its budget, or because the decision is certain."""
    ready = decide(command, SearchSettings(engine=engine), FOREVER)
    assert (ready.ticket, ready.error) == (7, "")
    assert 0 < ready.plan.iterations <= 200
    assert 0.0 < ready.plan.seconds < FOREVER
    assert not ready.cut


def test_past_its_deadline_the_best_found_stands(command):
    """A decision of a million iterations that may take 20 ms does not take them."""
    search = SearchSettings(search="paper", engine="python")
    ready = decide(dataclasses.replace(command, iterations=1_000_000), search, 0.02)
    assert ready.plan.iterations < 1_000_000
    assert ready.cut


def test_one_iteration_runs_even_when_the_deadline_is_over(command):
    """Without it the plan would be to drop, whatever the sample is worth."""
    ready = decide(command, SearchSettings(), 0.0)
    assert ready.plan.iterations == 1
    assert ready.plan.send


def test_a_planner_that_fails_is_told_as_such(command):
    """An error becomes an answer, so that the core can fall back."""
    broken = dataclasses.replace(command, problem=dataclasses.replace(command.problem, current=99))
    ready = decide(broken, SearchSettings(), FOREVER)
    assert ready.plan is None
    assert ready.error.startswith("ProblemError: ")


@pytest.mark.parametrize("error", [SystemExit("no"), CancelledError("late")])
def test_a_search_that_would_end_its_thread_has_failed(command, error):
    """A utility that raises what is no Exception is told like any other failure."""

    class Leaving:
        value = Video().value

        def integral(self, _start, _end):
            raise error

    messages = tuple(message._replace(utility=Leaving()) for message in command.problem.messages)
    broken = dataclasses.replace(command, problem=dataclasses.replace(command.problem, messages=messages))
    ready = decide(broken, SearchSettings(), FOREVER)
    assert (ready.plan, ready.error) == (None, f"{type(error).__name__}: {error}")


def test_a_decision_that_pauses_goes_on_where_it_was(command):
    """What a later thread finds is what one would have found; pauses are no time that the search took."""
    paper = SearchSettings(search="paper", engine="python")
    at_once = decide(command, paper, FOREVER)
    decision = Decision(command, paper, FOREVER)
    assert decision.work(clock.monotonic() - 1.0) is None
    assert decision.answer is None
    ready = decision.work()
    assert decision.answer is ready
    assert dataclasses.replace(ready.plan, seconds=None) == dataclasses.replace(at_once.plan, seconds=None)


def test_the_worker_answers_and_stops(command):
    """Each order is answered with its ticket; a closed worker has finished."""
    answers = queue.SimpleQueue()
    worker = Worker(0.1, answers.put)
    for ticket in (1, 2):
        worker.submit(ordered(command, ticket))
        assert answers.get(timeout=10.0).ticket == ticket
    worker.close(5.0)
    assert not worker._thread.is_alive()


def test_of_orders_that_wait_only_the_newest_is_answered(command):
    """The core does not wait for the others any more, so they keep nobody waiting."""
    answers, end = queue.SimpleQueue(), threading.Event()

    def slow(answer):
        answers.put(answer.ticket)
        end.wait(20.0)

    worker = Worker(0.1, slow)
    worker.submit(ordered(command))
    assert answers.get(timeout=10.0) == command.ticket
    for ticket in (8, 9, 10):
        worker.submit(ordered(command, ticket))
    end.set()
    assert answers.get(timeout=10.0) == 10
    worker.close(5.0)
    assert answers.qsize() == 0


def test_behind_a_decision_that_is_overdue_nothing_is_awaited():
    """Nobody knows when the one in hand comes to its end."""
    worker = Worker(0.1, lambda _: None)
    asked = clock.monotonic()
    assert not worker.busy(asked + 60.0)
    worker._began = asked
    assert not worker.busy(asked)
    assert worker.busy(asked + 60.0)


def test_the_deadline_counts_from_what_asked_for_the_decision(command):
    """Time that the event waited is no time for the search, and is told beside what the decision took."""
    search = SearchSettings(search="paper", engine="python")
    waited = dataclasses.replace(command, iterations=1_000_000, asked=command.asked - 100.0)
    ready = decide(waited, search, 50.0)
    assert ready.plan.iterations == 1
    assert ready.plan.seconds >= ready.overhead > 100.0


def test_a_decision_that_never_ends_is_noticed(command):
    """While nothing is decided nothing is stuck, nor what may still end in time."""
    end = threading.Event()
    worker = Worker(0.5, lambda _: end.wait(20.0))
    assert not worker.stuck(clock.monotonic() + 60.0)
    submitted = clock.monotonic()
    worker.submit(ordered(command))
    wait_until(lambda: worker.stuck(submitted + 60.0), what="the search to begin")
    assert not worker.stuck(submitted)
    end.set()
    wait_until(lambda: not worker.stuck(submitted + 60.0), what="its end")
    worker.close(1.0)
