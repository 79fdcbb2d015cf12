"""Robots of which only one has lost the other meet anew when both have."""

import zenoh

from proxy import clock
from proxy.bridge.half_open import HalfOpen
from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard, closing, free_endpoint, plain_session
from tests.waiting import wait_until

AGAIN = {"period_init_ms": 100, "period_max_ms": 100, "period_increase_factor": 1}


def half_opened(stack):
    """Return two peers that are linked, what the second sees of the first, and a way each to the other.

    The first has dialled; the way back is closed. A connection that is half open stays so: the second, which loses it,
    has promised to be heard of once in ten minutes.
    """
    first, second = free_endpoint(), free_endpoint()
    there = stack.enter_context(Counting(second))
    back = stack.enter_context(Counting(first, cut=True))
    loser = closing(
        stack, plain_session("peer", listen=(second,), connect=(back.endpoint,), retry=AGAIN, steadfast=True)
    )
    keeper = closing(stack, plain_session("peer", listen=(first,), connect=(there.endpoint,)))
    stack.callback(keeper.liveliness().declare_token("token/keeper").undeclare)
    seen = Seen(loser)
    wait_until(lambda: seen.alive, what="the token")
    return keeper, loser, seen, there, back


class Seen:
    """Whether the token is alive as far as its coming and going tells."""

    def __init__(self, session):
        self.alive = False
        self._subscriber = session.liveliness().declare_subscriber("token/*", self._note, history=True)

    def _note(self, sample):
        self.alive = sample.kind == zenoh.SampleKind.PUT


def test_who_kept_its_transport_ends_it_when_its_first_link_goes(stack):
    """Plain peers stay linked, and one never sees the token of the other again; with it they meet anew."""
    keeper, loser, seen, there, back = half_opened(stack)
    half_open = HalfOpen(keeper)
    stack.callback(half_open.close)
    there.halve()
    wait_until(lambda: not loser.info.peers_zid(), what="the loss, at one end")
    assert keeper.info.peers_zid()
    back.mend()
    wait_until(lambda: len(keeper.info.links()) == 2, what="the link from the other end")
    half_open.check(clock.monotonic())
    half_open.check(clock.monotonic())
    assert len(keeper.info.links()) == 2, "a second link is nothing to end"
    there.cut()
    wait_until(lambda: len(keeper.info.links()) == 1, what="the end of the first link")
    heard = Heard(keeper, "sample")
    assert not seen.alive, "this is what Zenoh does; if it does not any more, `HalfOpen` can go"
    wait_until(lambda: half_open.check(clock.monotonic()) or seen.alive, what="the token again")
    wait_until(lambda: loser.put("sample", "x") or heard.samples, what="a sample")


def test_a_link_that_ends_soon_says_nothing(stack):
    """It is one of two that were dialled at once, and the other one is good."""
    keeper, loser, _, there, back = half_opened(stack)
    half_open = HalfOpen(keeper, young=60.0)
    stack.callback(half_open.close)
    there.halve()
    wait_until(lambda: not loser.info.peers_zid(), what="the loss, at one end")
    first = [link.dst for link in keeper.info.links()]
    back.mend()
    wait_until(lambda: len(keeper.info.links()) == 2, what="the link from the other end")
    back.cut()
    wait_until(lambda: len(keeper.info.links()) == 1, what="its end")
    for _ in range(3):
        half_open.check(clock.monotonic())
    assert [link.dst for link in keeper.info.links()] == first


def test_links_that_end_with_their_transport_leave_nothing_to_do(stack, caplog):
    """Whoever goes and comes back is left alone."""
    endpoint = free_endpoint()
    keeper = closing(stack, plain_session("peer", listen=(endpoint,)))
    half_open = HalfOpen(keeper)
    stack.callback(half_open.close)
    caplog.set_level("INFO")
    for _ in range(3):
        with plain_session("peer", connect=(endpoint,)):
            wait_until(keeper.info.links, what="the link")
            for _ in range(3):
                half_open.check(clock.monotonic())
            assert keeper.info.links()
        wait_until(lambda: half_open.check(clock.monotonic()) or not keeper.info.links(), what="its end")
    assert "half open" not in caplog.text
