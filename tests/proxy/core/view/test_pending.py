"""News of streams whose keys are not known yet."""

from proxy.core.protocol.messages import StreamDigest
from tests.proxy.core.view.met import digest


def test_news_without_a_key_is_bounded(view):
    """Numbers that no state explains."""
    view.add_peer(0.0, "r2", "z-r2")
    news = tuple(StreamDigest(n, 1, 0, 1.0, 0.0, 10, 1.0) for n in range(1030))
    view.heard_digest(1.0, digest(1.0, *news))
    assert (len(view.peers["z-r2"].pending), view.peers["z-r2"].evicted) == (1024, 6)
