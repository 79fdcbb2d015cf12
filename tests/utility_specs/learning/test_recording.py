"""Recordings: what is written is read, and what is whole of a broken one."""

import io
import math

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.learning import Observed
from utility_specs.learning.recording import VERSION, Reader, RecordingError, Writer

SAMPLE = Observed(1.5, "robot/r1/camera", b"\xff\xd8\xff", "image/jpeg", b"\x01", "ab12")
HEADER = {"sendworthy": "recording", "version": VERSION, "robots": []}


def written(*samples, robots=()):
    file = io.BytesIO()
    writer = Writer(file, robots)
    for sample in samples:
        writer.add(sample)
    return file.getvalue()


def read(data):
    reader = Reader(io.BytesIO(data))
    return list(reader), reader


@given(
    st.lists(
        st.builds(
            Observed,
            time=st.floats(0.0, 1e9),
            key=st.text(),
            payload=st.binary(),
            encoding=st.text(),
            attachment=st.none() | st.binary(),
            origin=st.none() | st.text(),
        ),
        max_size=5,
    )
)
def test_what_is_written_is_read(samples):
    """Every sample comes back as it was."""
    found, reader = read(written(*samples, robots=("r1", "r2")))
    assert (found, reader.damage, reader.robots) == (samples, "", ("r1", "r2"))


def test_wherever_it_is_cut_off_what_is_whole_is_read():
    """A recording may end in the middle of a sample: it says so."""
    whole, two = written(SAMPLE), written(SAMPLE, SAMPLE)
    for end in range(len(whole) + 1, len(two)):
        found, reader = read(two[:end])
        assert (found, reader.damage) == ([SAMPLE], "the recording is cut off: 1 sample before that")


@pytest.mark.parametrize(
    "value",
    [
        7,
        ["1.5", "k", "", b"", None, None],
        [1.5, "k", "", "text", None, None],
        [1.5, "k", "", b"", "text", None],
        [1.5, "k", "", b"", None, 7],
        [math.nan, "k", "", b"", None, None],
        [math.inf, "k", "", b"", None, None],
        [1.5, "k"],
    ],
)
def test_what_is_no_sample_ends_it(value):
    """The samples before it count."""
    found, reader = read(written(SAMPLE) + msgpack.packb(value))
    assert found == [SAMPLE]
    assert reader.damage.startswith("sample 2 cannot be read, nor what follows: it is not [time, key")


def test_bytes_that_are_no_messagepack_end_it():
    """So do bytes that mean nothing."""
    found, reader = read(written(SAMPLE) + b"\xc1")
    assert found == [SAMPLE]
    assert reader.damage.startswith("sample 2 cannot be read")


def test_later_versions_may_append_to_samples():
    """What follows the six fields is left alone."""
    found, reader = read(msgpack.packb(HEADER) + msgpack.packb([1, "k", "", b"x", None, None, "more"]))
    assert (found, reader.damage) == ([Observed(1.0, "k", b"x")], "")


@pytest.mark.parametrize(
    "data", [b"", b"\xc1", b"robot", msgpack.packb({"sendworthy": "x"}), msgpack.packb(HEADER)[:9]]
)
def test_other_files_are_refused(data):
    """What does not begin like a recording is none."""
    with pytest.raises(RecordingError, match="is not a recording of"):
        Reader(io.BytesIO(data))


def test_other_versions_are_refused():
    """The message names both."""
    with pytest.raises(RecordingError, match="is a recording of version 9; this Sendworthy reads 1"):
        Reader(io.BytesIO(msgpack.packb(HEADER | {"version": 9})))


def test_odd_names_of_robots_are_left_out():
    """A header that is half wrong is half used."""
    assert read(msgpack.packb(HEADER | {"robots": ["r1", 7]}))[1].robots == ("r1",)
    assert read(msgpack.packb(HEADER | {"robots": "r1"}))[1].robots == ()
