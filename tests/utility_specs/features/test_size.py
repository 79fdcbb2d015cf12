"""The size of a sample as a feature."""

from utility_specs.features.sample import Sample
from utility_specs.features.size import Size, SizeTable


def test_the_size_is_the_length_of_the_payload():
    """In bytes, an empty one included."""
    feature = SizeTable(kind="size").feature()
    assert feature == Size()
    assert feature.reads_payload
    assert [feature.measure(Sample("k", payload)) for payload in (b"", b"abc")] == [0.0, 3.0]
