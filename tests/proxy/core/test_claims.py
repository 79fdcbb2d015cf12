"""Two robots that would send in the same moment: the one with the better claim does."""

import math

import pytest

from proxy.core.claims import CAUTION, DECIDED, both, claim, news_take, rivals
from proxy.core.disputes import Disputes
from proxy.core.limits import limits_of
from proxy.core.settings import CoreSettings
from proxy.core.stream import Generated, Sent
from proxy.core.view import SharedView

PERIOD, SIZE = 0.1, 1_000


@pytest.fixture
def view(make_specs):
    """Two robots with frames of 10 Hz and more to say than the limit carries; the other one is due at 10 s."""
    view = SharedView(CoreSettings("r1", "z1"), make_specs(window=0.25))
    view.add_peer(0.0, "r2", "z2")
    view.set_interest(("robot/**",))
    for robot in ("r1", "r2"):
        stream = view.stream(0.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(100):
            stream.note_generated(count + 1, Generated(count * PERIOD, SIZE, 1.0))
    return view


def taken(view, now):
    limits, disputes = limits_of(view.specs, 0.02, 2), Disputes(view)
    disputes.look(now, limits, alone=False)
    return rivals(now, view, disputes, view.known("r1", "robot/r1/camera"), limits)


def sent(view, robot, t):
    view.note_sent(view.known(robot, f"robot/{robot}/camera"), 1, Sent(t, t, SIZE, 1.0))


def test_a_better_claim_that_was_due_just_now_counts_as_taken(view):
    """The other one sent longer ago."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 + 0.5 * DECIDED) == (SIZE,)


def test_a_worse_claim_waits_for_us(view):
    """So never do both wait, nor both send."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 9.5)
    assert taken(view, 10.0 + 0.5 * DECIDED) == (0.0,)


def test_of_equal_claims_one_is_better(view):
    """Names tell which, alike everywhere."""
    sent(view, "r1", 9.5)
    sent(view, "r2", 9.5)
    assert taken(view, 10.0 + 0.5 * DECIDED) == (SIZE,)


def test_a_better_claim_that_comes_before_it_can_have_heard_of_us_counts_as_taken(view):
    """It would not wait for us; what comes later knows what we sent."""
    sent(view, "r1", 9.85)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 - 0.9 * news_take(view)) == (SIZE,)
    assert taken(view, 10.0 - 2.0 * news_take(view)) == (0.0,)


def test_what_we_would_have_heard_of_by_now_was_not_sent(view):
    """News take as long as the way, and deciding."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    assert taken(view, 10.0 + 2.0 * news_take(view)) == (0.0,)


def test_what_we_know_to_be_sent_is_counted_elsewhere(view):
    """It is no guess any more."""
    sent(view, "r1", 9.0)
    sent(view, "r2", 10.0)
    view.known("r2", "robot/r2/camera").renew(Generated(9.9, SIZE, 100.0))
    assert taken(view, 10.0 + 0.5 * DECIDED) == (0.0,)


def test_what_comes_at_random_counts_by_how_likely_it_was_sent(view):
    """Nobody knows when it is due: no more of it than would be taken of what was."""
    sent(view, "r1", 9.9)
    sent(view, "r2", 9.0)
    view.known("r2", "robot/r2/camera").schedule.assume(PERIOD, "poisson")
    likely = 1.0 - math.exp(-news_take(view) / PERIOD)
    assert taken(view, 10.0) == (pytest.approx(likely**CAUTION * SIZE),)


@pytest.mark.parametrize("later", [0.0, 0.2, 0.9])
def test_others_never_take_our_claim_for_less_than_it_is(view, later):
    """What they know of our sends is older: so no two robots find that their own claim is the best."""
    ours = view.known("r1", "robot/r1/camera")
    sent(view, "r1", 9.0)
    before = claim(10.0, ours)
    view.note_sent(ours, 2, Sent(9.0 + later, 9.0 + later, SIZE, 1.0))
    assert claim(10.0, ours) <= before


def test_two_messages_use_what_each_of_them_does():
    """Of every limit."""
    assert both((1.0, 2.0), (3.0, 0.5)) == (4.0, 2.5)
