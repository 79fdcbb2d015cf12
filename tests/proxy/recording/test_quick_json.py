"""What most of a recording is written by."""

import json
from types import MappingProxyType

from hypothesis import given
from hypothesis import strategies as st

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Drop, Forget, Forward, Notice, SendDigest, SendState, TellBacklog
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.recording.entries import EVENT_TYPES
from proxy.recording.json_data import plain, text
from proxy.recording.quick_json import line, lines, told
from proxy.recording.writing import described
from utility_specs import Specs

NUMBERS = st.floats() | st.integers(-5, 5)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8) | st.just("null")
COUNTS = st.integers(0, 2**70)
STREAMS = st.builds(StreamDigest, COUNTS, COUNTS, COUNTS, NUMBERS, NUMBERS, COUNTS, NUMBERS, st.tuples(NUMBERS))
DIGESTS = st.builds(
    Digest,
    TEXTS,
    TEXTS,
    NUMBERS,
    streams=st.lists(STREAMS, max_size=2).map(tuple),
    echoes=st.lists(st.builds(Echo, TEXTS, NUMBERS, NUMBERS, COUNTS, NUMBERS), max_size=2).map(tuple),
    capacity=st.lists(NUMBERS, max_size=2).map(tuple),
)
STATES = st.builds(
    State,
    TEXTS,
    TEXTS,
    TEXTS,
    TEXTS,
    streams=st.lists(st.builds(StreamState, COUNTS, TEXTS, TEXTS, NUMBERS)).map(tuple),
)
PLANS = st.none() | st.builds(
    Plan,
    send=st.booleans(),
    sends=st.just((1,)),
    utility=NUMBERS,
    opposite=st.none() | NUMBERS,
    iterations=COUNTS,
    nodes=COUNTS,
    lead=st.none() | NUMBERS,
    prices=st.tuples(NUMBERS),
)
FEATURES = st.dictionaries(TEXTS, NUMBERS, max_size=3)
EVENTS = (
    st.builds(ev.SampleHanded, NUMBERS, st.integers(0))
    | st.builds(
        ev.SamplePublished,
        NUMBERS,
        COUNTS,
        TEXTS,
        COUNTS,
        NUMBERS,
        st.none() | TEXTS,
        st.integers(1, 7),
        FEATURES | FEATURES.map(MappingProxyType),
        st.booleans(),
        COUNTS,
    )
    | st.builds(ev.DigestHeard, NUMBERS, DIGESTS, COUNTS)
    | st.builds(ev.DecisionReady, NUMBERS, COUNTS, PLANS, TEXTS, NUMBERS)
)
COMMANDS = st.lists(
    st.builds(Forward, COUNTS)
    | st.builds(Drop, COUNTS, TEXTS)
    | st.builds(SendDigest, DIGESTS)
    | st.builds(SendState, STATES, st.none() | STATES)
    | st.builds(TellBacklog, TEXTS, COUNTS, st.none() | st.lists(TEXTS).map(tuple), st.booleans())
    | st.builds(Notice, st.just("info"), TEXTS, st.dictionaries(TEXTS, TEXTS | COUNTS, max_size=2)),
    max_size=3,
)


def usual(event, commands):
    """Return an event with what followed as it is written where nothing is quick."""
    return text(plain(event) | ({"commands": list(map(described, commands))} if commands else {}))


@given(EVENTS, COMMANDS)
def test_it_is_the_same_data(event, commands):
    """The quick way writes what the other one writes, or leaves it to it."""
    made = line(event, commands)
    assert made is None or repr(json.loads(made)) == repr(json.loads(usual(event, commands)))


@given(st.lists(st.tuples(EVENTS, COMMANDS), min_size=1, max_size=4))
def test_many_at_once_are_what_each_is(happened):
    """Or all are left to the one-by-one way, where one is left to the usual one."""
    alone = [line(event, commands) for event, commands in happened]
    together = lines([event for event, _ in happened], [commands for _, commands in happened])
    assert together == (None if None in alone else alone)


def test_common_ones_go_the_quick_way():
    """Those that a sample makes that is sent, and what is told of it; described commands, too."""
    assert line(ev.SampleHanded(1.5, 7), ()) == b'{"now":1.5,"sample":7}'
    published = ev.SamplePublished(1.5, 7, "a", 9, 1.25, None, 5, {"red": 0.5})
    assert b'"origin":null' in line(published, ())
    assert b'"commands":[{"command":"Forward","sample":7},{"command":"Forget","sample":7}]' in line(
        published, (Forward(7), Forget(7))
    )
    assert line(published, (described(Forward(7)),)) == line(published, (Forward(7),))
    assert b'"split":null' in line(ev.TimePassed(1.0), (SendDigest(Digest("r1", "a", 0.5)),))
    assert b'"update":null' in line(ev.TimePassed(1.0), (SendState(State("r1", "a", "pass", "")),))
    assert line(ev.DecisionReady(1.0, 1, None, 0.5), ()) is not None


def test_what_json_has_no_word_for_is_left_to_the_usual_way():
    """Numbers that are not finite, wherever they stand, and specs, which are told by their generation."""
    infinite = float("inf")
    published = ev.SamplePublished(1.5, 7, "a", 9, 1.25, None, 5, {"red": infinite})
    stream = StreamDigest(1, 1, 1, 0.5, infinite, 1, 1.0)
    assert line(ev.SampleHanded(infinite, 7), ()) is None
    assert line(published, ()) is None
    assert line(ev.TimePassed(1.0), (Forward(1), SendDigest(Digest("r1", "a", 0.5, streams=(stream,))))) is None
    assert line(ev.SpecsChanged(1.0, Specs((), (), "abc")), ()) is None


def test_every_other_event_may_go_the_quick_way():
    """Of each class it can be told how many values are None."""
    assert {name for name, kind in EVENT_TYPES.items() if not told(kind)} == {"SpecsChanged"}
