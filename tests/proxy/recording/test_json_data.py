"""Dataclasses as JSON and back."""

import json
from dataclasses import dataclass, fields, is_dataclass
from typing import get_type_hints

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.bid import Segment
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.core.protocol.split_report import SplitReport
from proxy.recording.entries import EVENT_TYPES, FORMAT
from proxy.recording.errors import RecordingError
from proxy.recording.json_data import plain, read, schema, text
from utility_specs import Specs

NUMBERS = st.floats()
COUNTS = st.integers(0, 2**53)
TEXTS = st.text(max_size=8)
SEGMENTS = st.builds(Segment, st.integers(1, 10_000), st.integers(0, 255), st.sampled_from((0, 1, 2, 4)))
REPORTS = st.builds(
    SplitReport, COUNTS, st.none() | st.lists(SEGMENTS, max_size=2).map(tuple), COUNTS, COUNTS, st.just((1, 2))
)
STREAMS = st.builds(
    StreamDigest, COUNTS, COUNTS, COUNTS, NUMBERS, NUMBERS, COUNTS, NUMBERS, st.lists(NUMBERS, max_size=3).map(tuple)
)
DIGESTS = st.builds(
    Digest,
    TEXTS,
    TEXTS,
    NUMBERS,
    streams=st.lists(STREAMS, max_size=2).map(tuple),
    echoes=st.just((Echo("a", 1.0, 2.0, 3, 0.5),)),
    split=st.none() | REPORTS,
)
STATES = st.builds(
    State, TEXTS, TEXTS, TEXTS, TEXTS, streams=st.just((StreamState(1, "k", "t", 0.1),)), origins=st.just(("a",))
)
PLANS = st.builds(Plan, st.booleans(), st.just((1, 2)), NUMBERS, st.none() | NUMBERS, COUNTS, COUNTS, gap=NUMBERS)
FEATURES = st.dictionaries(TEXTS, NUMBERS, max_size=3)
EVENTS = (
    st.builds(ev.SamplePublished, NUMBERS, COUNTS, TEXTS, COUNTS, NUMBERS, st.none() | TEXTS, COUNTS, FEATURES)
    | st.builds(ev.SampleHeard, NUMBERS, TEXTS, COUNTS, st.none(), st.none() | NUMBERS, st.none() | FEATURES)
    | st.builds(ev.DigestHeard, NUMBERS, DIGESTS, COUNTS)
    | st.builds(ev.StateHeard, NUMBERS, STATES, COUNTS)
    | st.builds(ev.DecisionReady, NUMBERS, COUNTS, st.none() | PLANS, TEXTS, NUMBERS)
    | st.builds(ev.LinksGauged, NUMBERS, st.just((("a", 0.1), ("b", 0.2))))
    | st.builds(ev.ModeChanged, NUMBERS, st.sampled_from(Mode))
    | st.builds(ev.InterestChanged, NUMBERS, st.just(("a", "b")))
)


@given(EVENTS)
def test_events_come_back_to_the_last_bit(event):
    """Numbers that are not finite included; the text is JSON that anybody reads."""
    line = text(plain(event))
    assert "NaN" not in line.replace('"NaN"', "")
    data = json.loads(line, parse_constant=pytest.fail)
    assert repr(read(type(event), data)) == repr(event)


def test_every_event_can_be_read_and_has_a_schema():
    """What the core learns to take in is recorded, too."""
    for name, kind in EVENT_TYPES.items():
        assert schema(kind)["title"] == name
        assert set(schema(kind)["properties"]) == {field.name for field in fields(kind)}
        for hint in get_type_hints(kind).values():
            assert is_dataclass(kind)
            assert hint is not None


def test_numbers_in_schemas_are_numbers():
    """So Foxglove plots them."""
    properties = schema(ev.DecisionReady)["properties"]
    assert properties["overhead"] == {"type": "number"}
    assert properties["plan"]["properties"]["iterations"] == {"type": "integer"}
    assert schema(ev.SamplePublished)["properties"]["features"]["additionalProperties"] == {"type": "number"}
    assert schema(ev.InterestChanged)["properties"]["keys"] == {"type": "array", "items": {"type": "string"}}


def test_whole_numbers_stay_whole():
    """A core that was told 0 instead of 0.0 is told so again."""
    event = read(ev.ClockChanged, json.loads(text(plain(ev.ClockChanged(1, 0)))))
    assert type(event.wall_offset) is int
    assert type(event.error) is float


def test_settings_come_back():
    """With their infinite deadline, and the mode as one of the modes."""
    settings = CoreSettings("r1", "z", Mode.SHADOW)
    found = read(CoreSettings, json.loads(text(plain(settings))))
    assert found == settings
    assert found.mode is Mode.SHADOW


def test_specs_are_told_by_their_generation():
    """Their text stands elsewhere."""
    assert json.loads(text(plain(ev.SpecsChanged(1.0, Specs.empty()))))["specs"] == "0" * 12


def test_other_versions_are_read():
    """What is unknown is ignored, and what is not there takes its default."""
    assert read(ev.ClockChanged, {"now": 1.0, "wall_offset": 2.0, "colour": "red"}) == ev.ClockChanged(1.0, 2.0)
    assert FORMAT == 1


@dataclass(frozen=True)
class Raw:
    """Something with bytes and a pair."""

    data: bytes
    pair: tuple[int, str]


def test_bytes_are_hexadecimal_digits():
    """JSON has no bytes."""
    line = text(plain(Raw(b"\x00\xff", (1, "a"))))
    assert line == '{"data":"00ff","pair":[1,"a"]}'
    assert read(Raw, json.loads(line)) == Raw(b"\x00\xff", (1, "a"))


@pytest.mark.parametrize(
    ("kind", "data", "message"),
    [
        (ev.SampleHanded, {"now": 1.0}, 'a SampleHanded without "sample"'),
        (ev.SampleHanded, [], r"\[\] is no SampleHanded"),
        (ev.SampleHanded, {"now": "soon", "sample": 1}, "'soon' is no number"),
        (ev.SampleHanded, {"now": 1.0, "sample": "one"}, "'one' is no int"),
        (ev.SampleHanded, {"now": 1.0, "sample": True}, "True is no int"),
        (ev.ModeChanged, {"now": 1.0, "mode": "fast"}, "'fast' is none of pass, shadow, enforce"),
        (ev.InterestChanged, {"now": 1.0, "keys": "a"}, "'a' is no list"),
        (ev.LinksGauged, {"now": 1.0, "waits": [["a"]]}, "are not 2 values"),
        (ev.SampleHeard, {"now": 1, "key": "", "size": 0, "origin": None, "stamp": 1, "features": 3}, "3 is no table"),
        (CoreSettings, {"robot": "r", "zid": "z", "coordination": "chaos"}, "'chaos' is none of announce, split"),
        (Segment, {"amount": 0, "level": 0}, "no Segment: no segment of a bid"),
        (Raw, {"data": "xyz", "pair": [1, "a"]}, "no bytes in hexadecimal digits"),
        (Raw, {"data": 3, "pair": [1, "a"]}, "no bytes in hexadecimal digits"),
    ],
)
def test_what_is_none_is_refused(kind, data, message):
    """With what is wrong."""
    with pytest.raises(RecordingError, match=message):
        read(kind, data)
