"""Where there is ample room samples go without a search; where they would fill it, they are decided."""

from itertools import pairwise

import pytest

from planner import Throughput
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward
from proxy.core.market.tuning import TUNING
from proxy.core.market.undersubscribed import Undersubscribed, need
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.samples.tuning import TUNING as SAMPLES
from tests.proxy.core.talk import only

WINDOW, LIMIT = 0.5, 62_500.0
LIMITS = (Limit("throughput", WINDOW, LIMIT, Throughput(LIMIT, WINDOW)),)


@pytest.fixture
def talk(make_talk, make_specs):
    """A robot whose cameras somebody wants, and 10 kB in any second."""
    talk = make_talk(make_specs(limit="80 kbit/s", window=1.0))
    talk.want(0.0)
    return talk


def test_what_a_settled_stream_needs_is_one_message_more_than_fit_evenly(talk):
    """Four a second of 1 kB are three in some windows of half a second."""
    for k in range(20):
        talk.publish(0.25 * k)
    (stream,) = talk.core.view.streams.own()
    assert need(talk.core.view, stream, LIMITS, 5.0) == (pytest.approx(3000.0, rel=0.01),)


def test_what_a_new_stream_needs_is_twice_what_it_generated(talk):
    """However short its intervals are: a burst ends."""
    for k in range(10):
        talk.publish(1.0 + 0.001 * k)
    (stream,) = talk.core.view.streams.own()
    assert need(talk.core.view, stream, LIMITS, 1.1) == (20_000.0,)
    assert need(talk.core.view, stream, LIMITS, 2.0) == (pytest.approx(501_000.0, rel=0.01),)


@pytest.mark.parametrize("alone", [True, False])
def test_where_many_wait_new_streams_may_need_a_part_of_what_is_held(talk, alone):
    """A sample counts at once, what others need is looked at now and then. Where few wait it is a small part.

    Who wants the samples is new, too, and may need as much unless nobody else counts.
    """
    robots = 1.0 if alone else 2.0
    for robot in ("a", "b"):
        talk.publish(1.0, f"robot/{robot}/camera")
    first, second = talk.core.view.streams.own()
    undersubscribed = Undersubscribed(talk.core.view)

    def fits(now, stream, amount, waiting=TUNING.many_waiting + 1):
        undersubscribed.advance(now, LIMITS, alone=alone)
        undersubscribed.note(now, stream)
        return undersubscribed.fits([1.001 * robots * amount / TUNING.undersubscribed], waiting)

    assert fits(1.0, first, 4000.0)
    assert not fits(
        1.0, first, 0.99 * 4000.0 * TUNING.undersubscribed / TUNING.undersubscribed_new, TUNING.many_waiting
    )
    assert fits(1.0, first, 4000.0 * TUNING.undersubscribed / TUNING.undersubscribed_new, TUNING.many_waiting)
    assert not fits(1.0, second, 3990.0)
    talk.publish(1.01, "robot/b/camera")
    assert not fits(1.02, second, 4000.0)
    assert fits(1.02, second, 6000.0)


@pytest.mark.parametrize(("limit", "first"), [("8 Mbit/s", 30_000), ("80 kbit/s", 300)])
def test_a_burst_goes_without_a_search_where_the_limit_has_room_for_it(make_talk, make_specs, limit, first):
    """What comes while one is decided goes with the answer."""
    talk = make_talk(make_specs(limit=limit))
    talk.want(0.0)
    for n in range(100):
        talk.publish(1.0 + 0.0001 * n, f"robot/{n}/camera", size=200 if n else first)
    (decide,) = talk.all(Decide)
    talk.answer(1.01, decide, send=True)
    assert len(talk.all(Forward)) == 100 if limit == "8 Mbit/s" else len(talk.all(Forward)) <= 2


@pytest.mark.parametrize("told", [False, True])
def test_robots_of_which_nothing_is_known_may_need_as_much_as_we_do(make_talk, make_specs, told):
    """Of twelve on a tight limit each knew of one other, and took all to fit: twice the limit. Not who only listens."""
    talk = make_talk(make_specs(limit="80 kbit/s"))
    talk.want(0.0)
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    talk.tell(ev.StateHeard(0.0, State("r2", "z-r2", "enforce", "", (), (), number=1)))
    for k in range(36):
        now = 0.25 * k
        for robot, zid in (("op", "zz-op"), ("r2", "z-r2"))[: 1 + told]:
            talk.tell(ev.DigestHeard(now, Digest(robot, tag(zid), now, 0, 0, state=1), 40))
        for decide in only(talk.publish(now)[1], Decide):
            talk.answer(now, decide, send=True)
    assert talk.core.gate.appraisal.all_fits is told


def test_new_streams_that_come_all_the_time_need_no_search_on_an_idle_channel(make_talk, make_specs):
    """Nothing can be gained by dropping any of what is a small part of the limit, known or not."""
    talk = make_talk(make_specs(limit="8 Mbit/s"))
    talk.want(0.0)
    for n in range(100):
        talk.publish(1.0 + 0.1 * n, f"robot/{n}/camera", size=200)
    assert not talk.all(Decide)
    assert len(talk.all(Forward)) == 100


@pytest.mark.full
def test_of_a_burst_so_many_are_taken_up_at_one_event(make_talk, make_specs):
    """The core is called again at once for the rest."""
    talk = make_talk(make_specs(limit="80 Mbit/s"), inbox=1000)
    talk.want(0.0)
    for n in range(400):
        talk.publish(1.0, f"robot/{n}/camera", size=200 if n else 300_000)
    talk.answer(1.01, talk.all(Decide)[0], send=True)
    sent = [len(talk.all(Forward))]
    while sent[-1] < 400:
        assert talk.core.wake_at(1.01) == 1.01
        talk.tell(ev.TimePassed(1.01))
        sent.append(len(talk.all(Forward)))
    assert [after - before for before, after in pairwise(sent)][:2] == [
        SAMPLES.taken_up_at_once,
        SAMPLES.taken_up_at_once,
    ]


def test_settled_streams_that_need_little_go_without_a_search(talk):
    """As long as they do."""
    searched = []
    for k in range(20):
        sample, commands = talk.publish(0.25 * k)
        searched.append(bool(only(commands, Decide)))
        for decide in only(commands, Decide):
            talk.answer(0.25 * k, decide, send=True)
        talk.tell(ev.DigestHeard(0.25 * k, Digest("op", tag("zz-op"), 0.25 * k, 0, 0, state=1), 40))
    assert searched[:7] == [True] * 7
    assert not any(searched[10:])
    sample, commands = talk.publish(5.0)
    assert only(commands) == [Forward(sample)]
    assert talk.core.status(5.0)["decisions"]["unneeded"] == talk.core.gate.decisions.shortcuts["unneeded"] > 8
