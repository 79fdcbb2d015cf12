"""What a digest says of the split, on the wire."""

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import Segment
from proxy.core.protocol.split_report import SplitReport, read_report, report_fields

segments = st.builds(Segment, st.integers(1, 10_000), st.integers(0, 255), st.sampled_from([0, 1, 2, 4]))
names = st.integers(1, 2**32 - 1)
reports = st.builds(
    SplitReport,
    st.integers(0, 2**32 - 1),
    st.none() | st.lists(segments, max_size=8).map(tuple),
    names,
    st.just(0) | names,
    st.lists(st.integers(0, 2**32 - 1), max_size=5).map(tuple),
    st.floats(0.0, 10.0),
    st.integers(0, 2**64 - 1),
)
anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.binary(max_size=26) | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=6),
)


@given(reports)
def test_a_report_survives_the_wire(report):
    """But for the time without use, which is rounded down: it may look shorter, never longer."""
    heard = read_report(msgpack.unpackb(msgpack.packb(report_fields(report))))
    assert (heard.version, heard.bid, heard.table) == (report.version, report.bid, report.table)
    assert (heard.agreed, heard.turns, heard.missing) == (report.agreed, report.turns, report.missing)
    assert heard.unused <= report.unused + 1e-9


@given(st.lists(anything, max_size=8) | reports.map(report_fields))
def test_what_is_malformed_is_refused(data):
    """Whatever comes is either understood or a `ValueError`."""
    try:
        report = read_report(data)
    except ValueError:
        return
    assert read_report(report_fields(report)) == report


@pytest.mark.parametrize(
    ("report", "most"),
    [
        (SplitReport(3, None, 0xFEDCBA98, 0xFEDCBA98), 7),
        (SplitReport(300, None, 0xFEDCBA98, 0xFEDCBA98, (120, 300), 0.5), 17),
        (SplitReport(300, tuple(Segment(4160, 120, 1) for _ in range(6)), 0xFEDCBA98, 0xFEDCBA97, (120, 300), 0.5), 40),
    ],
)
def test_a_digest_says_it_in_few_bytes(report, most):
    """A settled one without slots, one with two, and one with a bid that is news."""
    assert len(msgpack.packb(report_fields(report))) <= most
