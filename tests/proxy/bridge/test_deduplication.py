"""Each sample is taken once, though several declarations match it and come and go meanwhile."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge import deduplication as deduplication_module
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.deduplication import Deduplication, of_query, of_sample
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until

EXPRESSIONS = ["**", "a/*", "*/b", "a/b", "a/**", "**/b"]


class Zenoh:
    """The declarations as Zenoh keeps them: it calls those that matched when a sample came, one after the other."""

    def __init__(self):
        self.overlap = Deduplication(lambda contents: (contents,))
        self.handlers = {}

    def declare(self, expression, *, complete=False):
        """Declare `expression`; return what Zenoh would call with a sample."""

        def declared(handler):
            self.handlers[expression] = handler
            return SimpleNamespace()

        self.overlap.declare(expression, lambda number, contents: (number, contents), declared, complete=complete)

    def call(self, expression, contents="x", *, complete=False):
        """Whether a call takes what came."""
        number, _ = self.handlers[expression].callback(contents)
        return self.overlap.takes(number, "a/b", contents, complete=complete)

    def undeclare(self, expression):
        """Give a callback up, with nothing under way to it."""
        self.handlers.pop(expression).drop()


@pytest.fixture
def one():
    """A session with `a/b` and `**`."""
    found = Zenoh()
    for expression in ("a/b", "**"):
        found.declare(expression)
    return found


def test_what_was_declared_beside_another_takes_the_next_sample_once_that_is_gone(one):
    """The round of a sample of which only one was called does not swallow the next."""
    assert one.call("a/b", 1)
    one.undeclare("a/b")
    assert one.call("**", 2)
    assert one.call("**", 2)


def test_equal_samples_are_told_apart_by_who_is_called(one):
    """Of five with the same contents each is taken once, in whatever order Zenoh calls, also when one of two leaves."""
    for order in (("a/b", "**"), ("**", "a/b")):
        assert [one.call(name) for name in order * 5] == [True, False] * 5
    one.undeclare("a/b")
    assert [one.call("**") for _ in range(5)] == [True] * 5


def test_a_sample_that_came_while_another_was_only_being_declared_costs_the_next_one_nothing():
    """It was not called for that sample, but is the only one called for the next, which is equal to it."""
    one, seen = Zenoh(), []
    one.declare("a/b")
    one.overlap.declare(
        "**", lambda number, contents: (number, contents), lambda handler: seen.extend([one.call("a/b"), handler])
    )
    one.handlers["**"] = seen[1]
    one.undeclare("a/b")
    assert [seen[0], one.call("**")] == [True, True]


@pytest.mark.parametrize("equal", range(4))
def test_equal_samples_after_that_are_each_taken_once_and_so_is_the_first_without_the_other(equal):
    """Whether its calls were the last ones of one sample or the first ones of the next cannot be seen; none is lost."""
    one, seen = Zenoh(), []
    one.declare("a/b")
    one.overlap.declare(
        "**", lambda number, contents: (number, contents), lambda handler: seen.extend([one.call("a/b"), handler])
    )
    one.handlers["**"] = seen[1]
    assert [[one.call("**"), one.call("a/b")].count(True) for _ in range(equal)] == [1] * equal
    one.undeclare("a/b")
    assert [one.call("**") for _ in range(3)] == [True] * 3


def test_what_is_under_way_to_one_that_was_undeclared_is_not_taken_twice(one):
    """Zenoh still calls both for a sample that came before; only then it gives the callback up."""
    assert [one.call("**"), one.call("a/b")] == [True, False]
    assert [one.call("a/b"), one.call("**")] == [True, False]


def test_what_is_given_up_in_the_middle_of_a_round_leaves_the_rest_of_it_as_it_is(one):
    """Zenoh gives a callback up once it was called, before it calls the others for the same sample."""
    assert one.call("a/b")
    one.undeclare("a/b")
    assert not one.call("**")
    assert one.call("**")


def test_a_query_for_complete_ones_leaves_nothing_to_wait_for():
    """The others are not called for it; so the next one, to whomever it comes first, is another query."""
    one = Zenoh()
    one.declare("a/b", complete=True)
    one.declare("**")
    assert one.call("a/b", complete=True)
    one.undeclare("a/b")
    one.declare("a/*")
    assert [one.call("**"), one.call("a/*")] == [True, False]


@given(
    st.lists(st.tuples(st.sampled_from(EXPRESSIONS), st.booleans(), st.permutations(EXPRESSIONS)), max_size=30),
    st.booleans(),
)
def test_every_sample_is_taken_once_whatever_comes_and_goes(changes, told_apart):
    """Between two samples one declaration comes or goes, while another always stands; Zenoh calls in any one order."""
    one, numbers = Zenoh(), itertools.count()
    one.declare("*/*")
    for expression, comes, order in changes:
        if comes and expression not in one.handlers:
            one.declare(expression)
        elif not comes and expression in one.handlers:
            one.undeclare(expression)
        contents = next(numbers) if told_apart else "x"
        called = [name for name in (*order, "*/*") if name in one.handlers]
        assert [one.call(name, contents) for name in called].count(True) == 1


def test_the_cache_is_bounded(monkeypatch):
    """More keys than it remembers cost time, not memory, and change no answer."""
    monkeypatch.setattr(deduplication_module, "BOUNDS", replace(BOUNDS, keys=4))
    overlap = Deduplication(of_sample)
    overlap.declare("k/*", print, lambda _: SimpleNamespace())
    for _ in range(2):
        assert all(overlap.covers(f"k/{i}") for i in range(10))
    assert not overlap.covers("other")
    assert len(overlap._cache) <= 4


def test_what_cannot_be_declared_matches_nothing():
    """A declaration that Zenoh refuses leaves nothing behind."""

    def refuse(_):
        raise zenoh.ZError("no")

    overlap = Deduplication(of_sample)
    with pytest.raises(zenoh.ZError):
        overlap.declare("k/*", print, refuse)
    assert not overlap.covers("k/a")


def test_zenoh_calls_as_is_assumed_here(stack):
    """What calls for one sample, or query, hold is equal, and a callback is given up when it is undeclared."""
    endpoint = free_endpoint()
    router = closing(stack, plain_session("router", listen=(endpoint,)))
    node = closing(stack, plain_session("client", connect=(endpoint,)))
    samples, queries = Deduplication(of_sample), Deduplication(of_query)
    seen, asked = [], []
    subscribers = [
        samples.declare(
            name,
            lambda number, sample: seen.append((samples.takes(number, "k/a", sample), of_sample(sample))),
            lambda handler, name=name: router.declare_subscriber(name, handler),
        )
        for name in ("k/*", "k/a", "**")
    ]

    def answer(number, query):
        asked.append((queries.takes(number, "k/a", query), of_query(query)))
        query.drop()

    answering = [
        queries.declare(name, answer, lambda handler, name=name: router.declare_queryable(name, handler))
        for name in ("k/*", "k/a")
    ]
    publisher = node.declare_publisher("k/a")
    wait_until(lambda: publisher.matching_status.matching, what="the subscribers")
    info = zenoh.SourceInfo(publisher.id, 7)
    publisher.put("x", attachment=b"y", source_info=info)
    wait_until(lambda: len(seen) == 3, what="all calls")
    wait_until(lambda: list(node.get("k/a?n=1", payload=b"x", source_info=info)) or len(asked) >= 2, what="the query")
    assert [taken for taken, _ in seen] == [True, False, False]
    assert [taken for taken, _ in asked] == [True, False]
    assert len({str(contents[0]) for _, contents in seen}) == 1
    for subscriber in subscribers:
        subscriber.undeclare()
    wait_until(lambda: not samples.covers("k/a"), what="the end of all")
    del answering
