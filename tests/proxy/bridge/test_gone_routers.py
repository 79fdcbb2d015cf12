"""Applications in router mode, and what is behind them, that go without a word."""

import pytest

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
