"""How samples travel."""

from proxy.core.model.settings import UNICAST, broadcast, is_broadcast


def test_transports_are_told_apart():
    """Those on two groups are two."""
    assert [is_broadcast(t) for t in (broadcast("224.0.0.226:7449"), UNICAST, "")] == [True, False, False]
    assert broadcast("224.0.0.226:7449") == "broadcast 224.0.0.226:7449" != broadcast("224.0.0.226:7450")
