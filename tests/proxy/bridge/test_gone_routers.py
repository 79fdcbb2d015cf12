"""Applications in router mode, and what is behind them, that go without a word."""

from dataclasses import replace

import pytest

from proxy.bridge import gone_routers as gone_routers_module
from proxy.bridge.gone_routers import GoneRouters
from proxy.bridge.tuning import TUNING
from tests.proxy.bridge.test_mirroring import tokens
from tests.proxy.nodes import Heard, closing, plain_session, wait_matching
from tests.waiting import wait_until


@pytest.fixture
def near(pair):
    return pair[1].node()


def test_what_a_router_declared_is_gone_with_it(stack, pair, near):
    """On the other robot, too; what another application declared stays, as far as it is not the same."""
    router = plain_session("router", connect=(pair[0].app_endpoint,))
    behind = closing(stack, plain_session("client", connect=(pair[0].app_endpoint,)))
    ours = Heard(behind, "free/kept")
    kept_tokens = ["alive/kept", "@verbatim/kept"]
    kept = [behind.liveliness().declare_token(token) for token in kept_tokens]
    service = behind.declare_queryable("kept", lambda _: None)
    theirs = Heard(router, "free/gone")
    gone = router.liveliness().declare_token("alive/gone"), router.declare_queryable("gone", lambda _: None)
    publishers = {name: near.declare_publisher(f"free/{name}") for name in ("kept", "gone")}
    queriers = {name: near.declare_querier(name) for name in ("kept", "gone")}

    def there():
        found = {name for name in publishers if publishers[name].matching_status.matching}
        alive = tokens(near) | {str(reply.ok.key_expr) for reply in near.liveliness().get("@verbatim/*") if reply.ok}
        return found, {name for name in queriers if queriers[name].matching_status.matching}, alive

    wait_until(lambda: there() == ({"kept", "gone"}, {"kept", "gone"}, {*kept_tokens, "alive/gone"}), what="all of it")
    router.close()
    wait_until(lambda: there() == ({"kept"}, {"kept"}, set(kept_tokens)), what="what the router declared to be gone")
    wait_matching(near, "free/kept")
    near.put("free/kept", "still")
    wait_until(lambda: "still" in ours.payloads, what="a sample")
    del kept, service, gone, theirs


def test_what_something_wider_hid_is_gone_when_that_is(stack, pair, near, monkeypatch):
    """Whoever publishes has somebody who subscribes all the same, until then."""
    monkeypatch.setattr(gone_routers_module, "TUNING", replace(TUNING, gone_looked_for=0.0))
    router = plain_session("router", connect=(pair[0].app_endpoint,))
    wider = Heard(closing(stack, plain_session("client", connect=(pair[0].app_endpoint,))), "free/**")
    theirs = Heard(router, "free/gone")
    publisher = near.declare_publisher("free/gone")
    table = pair[0]._sides.apps
    wait_until(lambda: {"free/**", "free/gone"} <= table.declared("subscriber").keys(), what="both")
    wait_until(lambda: publisher.matching_status.matching, what="both on the other robot")
    router.close()
    wait_until(lambda: str(router.zid()) not in map(str, pair[0].app.info.routers_zid()), what="the router to be gone")
    assert publisher.matching_status.matching
    wider.subscriber.undeclare()
    wait_until(lambda: not publisher.matching_status.matching, what="what the router declared to be gone")
    del theirs


class Declared:
    """Declarations of which one look fails."""

    def __init__(self):
        self.edition, self.looks = 0, 0

    def forget_gone(self, own):
        assert own == {"ours"}
        self.looks += 1
        if self.looks == 1:
            raise RuntimeError


def test_a_look_that_fails_is_taken_again(stack):
    """And there is another one when declarations have changed, but not at once."""
    session = closing(stack, plain_session("router"))
    declared = Declared()
    gone = GoneRouters(session, declared, lambda: {"ours"})
    assert gone.check(100.0) is None
    gone._gone = True
    due = gone.check(100.0)
    assert due == 100.0 + TUNING.router_forgotten
    with pytest.raises(RuntimeError):
        gone.check(due)
    assert gone.check(due) is None
    assert declared.looks == 2
    declared.edition += 1
    assert gone.check(due + TUNING.gone_looked_for / 2) is None
    assert declared.looks == 2
    assert gone.check(due + TUNING.gone_looked_for) is None
    assert declared.looks == 3
