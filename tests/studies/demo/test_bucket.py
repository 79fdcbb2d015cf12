"""The token bucket of the medium."""

from studies.demo.bucket import Bucket


def test_a_full_bucket_gives_its_depth_at_once_and_then_its_rate():
    """What was saved up goes at once; after that tokens come at the rate."""
    bucket = Bucket(rate=100.0, depth=50.0, now=0.0)
    assert bucket.take(50, 0.0)
    assert not bucket.take(10, 0.05)
    assert bucket.take(10, 0.1)


def test_the_bucket_says_how_long_to_wait():
    """Waiting as long as it says is enough, and a full bucket asks for no wait."""
    bucket = Bucket(rate=100.0, depth=50.0, now=0.0)
    assert bucket.wait(50, 0.0) == 0.0
    assert bucket.take(40, 0.0)
    assert bucket.wait(30, 0.1) == 0.1
    assert bucket.take(30, 0.2)


def test_a_bucket_saves_no_more_than_its_depth():
    """A long silence is worth one depth."""
    bucket = Bucket(rate=100.0, depth=50.0, now=0.0)
    assert bucket.take(50, 1000.0)
    assert not bucket.take(1, 1000.0)
