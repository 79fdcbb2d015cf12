"""What is in digests and announcements."""

from proxy.core.gossip.digest_composer import brief
from proxy.core.protocol.messages import StreamDigest


def test_an_announcement_leaves_out_what_is_as_usual():
    """The size where it is the typical one and nothing follows it, the value where it is that of its type."""

    def announced(size=100, scale=1.0, features=()):
        news = brief(StreamDigest(1, 2, 0, 2.0, 0.0, size, scale, features), 100, 1.0)
        return news.size, news.scale, news.features

    assert announced() == (0, -1.0, ())
    assert announced(size=101) == (101, -1.0, ())
    assert announced(scale=2.0) == (100, 2.0, ())
    assert announced(features=(0.25,)) == (0, -1.0, ())
