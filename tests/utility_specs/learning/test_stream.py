"""What is seen of one stream."""

from itertools import pairwise

from tests.utility_specs.learning.team import json_bytes, picture, regular, stream_of
from utility_specs.learning.leaves import Leaf
from utility_specs.learning.stream import MOST_LOOKS


def test_it_counts_and_measures():
    """Samples, bytes, sizes and how they come."""
    stream = stream_of(regular("k", 2.0, lambda i: b"\xff" * (10 + i % 3), 10.0))
    assert (stream.count, stream.bytes, stream.size, stream.format) == (20, 219, 11, "raw")
    assert (stream.timing.kind, round(stream.timing.period, 6)) == ("periodic", 0.5)
    assert stream.shows == ()


def test_documents_and_images_are_looked_into():
    """What they show is a series for each number."""
    stream = stream_of(regular("k", 1.0, lambda i: json_bytes(charge=i, on=True), 3.0))
    assert stream.shows == (Leaf("charge"), Leaf("on"))
    assert stream.series(Leaf("charge")) == [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]
    assert stream_of(regular("k", 1.0, lambda _: picture(0.5), 2.0)).series("red")[0][1] > 0.4


def test_of_many_samples_some_are_looked_into_from_begin_to_end():
    """So that a long recording takes no more memory."""
    stream = stream_of(regular("k", 1.0, lambda i: json_bytes(i=i), 5 * MOST_LOOKS))
    times = [look.time for look in stream.looks]
    assert MOST_LOOKS / 2 <= len(times) <= MOST_LOOKS
    assert (times[0], max(times) > 0.99 * 5 * MOST_LOOKS, stream.count) == (0.0, True, 5 * MOST_LOOKS)
    assert len({b - a for a, b in pairwise(times)}) == 1


def test_its_format_is_that_of_most_samples():
    """One odd sample changes nothing."""
    odd = {3: b"\xff\xfe"}
    assert stream_of(regular("k", 1.0, lambda i: odd.get(i, b"{}"), 5.0)).format == "json"
