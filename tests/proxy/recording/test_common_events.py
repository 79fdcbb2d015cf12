"""The events that make most of a recording."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Drop, Forget, Forward
from proxy.recording.common_events import common
from proxy.recording.json_data import plain, text
from proxy.recording.writing import described

NUMBERS = st.floats(allow_nan=False) | st.integers(-5, 5)
TEXTS = st.text(max_size=8)
EVENTS = st.builds(ev.SampleHanded, NUMBERS, st.integers(0)) | st.builds(
    ev.SamplePublished,
    NUMBERS,
    st.integers(0),
    TEXTS,
    st.integers(0),
    NUMBERS,
    st.none() | TEXTS,
    st.integers(1, 7),
    st.dictionaries(TEXTS, NUMBERS, max_size=3),
    st.booleans(),
    st.integers(0),
)
COMMANDS = st.lists(st.builds(Forward, st.integers(0)) | st.builds(Drop, st.integers(0), TEXTS), max_size=3)


@given(EVENTS, COMMANDS)
def test_it_is_the_same_text(event, commands):
    """The quick way writes what the other one writes, or leaves it to it."""
    line = common(event, commands)
    told = plain(event) | ({"commands": list(map(described, commands))} if commands else {})
    assert line is None or line == text(told)


def test_common_ones_go_the_quick_way():
    """Those that a sample makes that is sent."""
    assert common(ev.SampleHanded(1.5, 7), ()) == '{"now":1.5,"sample":7}'
    published = ev.SamplePublished(1.5, 7, "a", 9, 1.25, "id", 5, {"red": 0.5})
    assert '"commands":[{"command":"Forward","sample":7}]' in common(published, (Forward(7),))


def test_others_are_left_to_the_usual_way():
    """Other events, other commands, numbers that JSON has no word for."""
    assert common(ev.TimePassed(1.0), ()) is None
    assert common(ev.SampleHanded(1.5, 7), (Forward(7),)) is None
    assert common(ev.SampleHanded(float("inf"), 7), ()) is None
    assert common(ev.SampleHanded(1, 7), ()) is None
    assert common(ev.SamplePublished(1.5, 7, "a", 9, 1.25, None, 5, {}), (Forget(7),)) is None
