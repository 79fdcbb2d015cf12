"""What others subscribe to is told from what we do, on real sessions."""

import threading

import pytest
import zenoh

from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.witnesses import Witnesses, examples
from tests.proxy.nodes import Heard, closing, free_endpoint, pass_fence, plain_session
from tests.waiting import wait_until


@pytest.fixture
def nodes(stack):
    """A main session and another node."""
    endpoint = free_endpoint()
    main = closing(stack, plain_session("router", listen=(endpoint,)))
    return main, closing(stack, plain_session("client", connect=(endpoint,)))


@pytest.fixture
def turns():
    return []


@pytest.fixture
def witnesses(stack, nodes, turns):
    made = Witnesses(nodes[0], lambda: turns.append(1))
    stack.callback(made.close)
    return made


def told(*expressions):
    return dict.fromkeys(expressions, False)


def test_what_only_others_declare_is_theirs(witnesses):
    """Nothing of our own: all that is told is of others, and needs no witness."""
    assert witnesses.others(told("a", "b/*"), (), 0.0) == told("a", "b/*")
    assert not witnesses.waiting


@pytest.mark.parametrize("expression", ["a/b", "a/*", "a/**", "**", "a/$*b", "@x/*", "**/@adv/**"])
def test_what_we_declare_is_of_others_exactly_while_they_declare_it_too(nodes, witnesses, turns, expression):
    """The witness turns when another node subscribes to the same, and again when it ceases to."""
    ours = Heard(nodes[0], expression)
    assert witnesses.others(told(expression), {expression}, 0.0) == {}
    theirs = Heard(nodes[1], expression)
    wait_until(lambda: turns, what="the turn")
    assert witnesses.waiting
    assert witnesses.others(told(expression), {expression}, 0.0) == told(expression)
    turns.clear()
    theirs.subscriber.undeclare()
    wait_until(lambda: turns, what="the other turn")
    assert witnesses.others(told(expression), {expression}, 0.0) == {}
    del ours


def test_who_asks_need_not_wait_for_the_turn_to_be_told(stack, nodes):
    """Zenoh tells of a turn on a thread of its own, some time after a query of the same node may have come."""
    late, heard = threading.Event(), Heard(nodes[0], "a/b")
    witnesses = Witnesses(nodes[0], late.wait)
    stack.callback(witnesses.close)
    stack.callback(late.set)
    witnesses.others(told("a/b"), {"a/b"}, 0.0)
    assert not witnesses.ask()
    theirs = Heard(nodes[1], "a/b")
    pass_fence(nodes[1], nodes[0])
    assert witnesses.ask()
    assert not witnesses.ask()
    del heard, theirs


def test_who_asks_is_told_that_somebody_left(nodes, witnesses, turns):
    """What nobody wants any more is no less news than what somebody wants: nothing else will tell of it."""
    ours, theirs = Heard(nodes[0], "a/b"), Heard(nodes[1], "a/b")
    wait_until(lambda: witnesses.others(told("a/b"), {"a/b"}, 0.0) == told("a/b"), what="the other node")
    turns.clear()
    theirs.subscriber.undeclare()
    wait_until(lambda: turns, what="the turn")
    assert witnesses.ask()
    assert not witnesses.waiting
    assert witnesses.others(told("a/b"), {"a/b"}, 0.0) == {}
    del ours


def test_narrower_subscribers_are_not_taken_for_ours(nodes, witnesses):
    """Others that want less than we declare do not make it theirs."""
    narrower = [Heard(nodes[1], key) for key in ("a", "a/b", "a/*/c", "*/b", "**/d")]
    probe = nodes[0].declare_publisher("x/d")
    wait_until(lambda: probe.matching_status.matching, what="the last of them")
    both = told("a/*", "**")
    assert witnesses.others(both, both.keys(), 0.0) == {}
    del narrower


def test_what_was_ours_a_moment_ago_is_not_taken_for_others(nodes, witnesses):
    """The wire tells of the end a little later; until then the witness speaks."""
    ours = Heard(nodes[0], "a")
    assert witnesses.others(told("a"), {"a"}, 0.0) == {}
    ours.subscriber.undeclare()
    assert witnesses.others(told("a"), (), 1.0) == {}
    assert witnesses.others(told("a"), (), 1.0 + 2 * TUNING.echo) == {}
    assert witnesses.waiting
    assert witnesses.others({}, (), 1.0 + 2 * TUNING.echo) == {}
    assert not witnesses.waiting
    assert witnesses.others(told("a"), (), 3.0) == told("a")


@pytest.mark.parametrize("expression", ["a", "a/*", "**", "a/**", "**/a/**", "a/$*d/b$*c", "@x/**", "a/*/@y/**/b"])
def test_the_expression_itself_matches_its_examples(expression):
    """Examples are keys, and the expression includes each."""
    for example in examples(expression):
        assert "*" not in example
        assert zenoh.KeyExpr(expression).includes(example)
