"""Which streams are of one kind, and the keys that cover them."""

import zenoh
from hypothesis import given
from hypothesis import strategies as st

from tests.utility_specs.learning.team import json_bytes, regular, streams_of
from utility_specs.key_formats import KeyFormat
from utility_specs.learning.patterns import MOST_KEYS, kinds_of
from utility_specs.learning.writing import named

BATTERY = json_bytes(charge=0.5)
POSE = json_bytes(x=1, y=2)
STRING = "std_msgs::msg::dds_::String_/RIHS01_df66"


def sent(key, payload=BATTERY, rate=1.0, seconds=10.0):
    return regular(key, rate, lambda _: payload, seconds)


def keys_of(*all_samples, robots=()):
    """The keys of each kind, sorted."""
    return sorted(kind.keys for kind in kinds_of(streams_of(*all_samples), robots))


def test_numbers_in_keys_stand_for_robots():
    """Whatever else they publish."""
    samples = [sent(f"robot/{name}/battery") for name in ("r1", "r2", "r10")]
    samples += [sent(f"robot/{name}/pose", POSE, 10.0) for name in ("r1", "r2", "r10")]
    assert keys_of(*samples) == [("robot/*/battery",), ("robot/*/pose",)]


def test_words_that_are_followed_by_the_same_stand_for_robots():
    """If what follows is alike in traffic."""
    loads = {"battery": BATTERY, "pose": POSE}
    samples = [sent(f"{name}/{what}", load) for name in ("alice", "bob") for what, load in loads.items()]
    assert keys_of(*samples) == [("*/battery",), ("*/pose",)]


def test_words_at_the_end_say_what_it_is():
    """However alike the traffic."""
    assert keys_of(sent("robot/r1/front"), sent("robot/r1/rear")) == [("robot/r1/front",), ("robot/r1/rear",)]


def test_words_whose_traffic_differs_are_no_names():
    """In content, in rate, in size, or in how often they come at all."""
    for other in (
        sent("gps/state", POSE),
        sent("gps/state", rate=10.0),
        sent("gps/state", json_bytes(charge=[0.5] * 100)),
        sent("gps/state", rate=0.1),
        sent("gps/state", b"text"),
    ):
        samples = [sent("arm/state", rate=5.0 if len(other) == 1 else 1.0), other]
        assert keys_of(*samples) == [("arm/state",), ("gps/state",)]
    assert len(keys_of(sent("arm/raw", b"\xff" * 60), sent("gps/raw", b"\xff" * 80))) == 2


def test_several_chunks_may_differ():
    """Links between robots have two names."""
    names = ("r1", "r2", "r3")
    samples = [sent(f"robot/{a}/link/{b}/quality") for a in names for b in names if a != b]
    assert keys_of(*samples) == [("robot/*/link/*/quality",)]


def test_a_pattern_covers_nobody_else():
    """Where a whole chunk would, a part of it is the pattern, and else every key is named."""
    assert keys_of(sent("r1/cam0"), sent("r1/cam1"), sent("r1/pose", POSE)) == [("r1/cam$*",), ("r1/pose",)]
    ids = ["0123abcd", "4567cdef"]
    assert keys_of(*(sent(f"r1/{name}") for name in ids), sent("r1/pose", POSE)) == [
        tuple(f"r1/{name}" for name in ids),
        ("r1/pose",),
    ]


def test_robots_whose_names_are_known_stand_for_all():
    """Even if only one of them was seen; the first chunk that names one has a name itself."""
    assert keys_of(sent("robot/alice/battery"), robots=["alice"]) == [("robot/${robot:*}/battery",)]
    names = ("alice", "bob")
    links = [sent(f"robot/{a}/link/{b}/quality") for a in names for b in names]
    assert keys_of(*links, robots=names) == [("robot/${robot:*}/link/*/quality",)]
    assert keys_of(sent("robot/alice/battery")) == [("robot/alice/battery",)]


def test_much_unlike_traffic_is_no_kind_even_by_number():
    """A sensor that is something else for one robot has a type of its own."""
    assert keys_of(sent("robot/1/s"), sent("robot/2/s", POSE)) == [("robot/1/s",), ("robot/2/s",)]


def test_topics_of_ros_end_before_their_type():
    """Their last name says what it is, and the hash of the type is any."""
    topics = ("alice/state", "bob/state", "chatter", "rumor")
    assert keys_of(*(sent(f"0/{topic}/{STRING}", b"\0\1\0\0abcd") for topic in topics)) == [
        ("0/*/state/std_msgs::msg::dds_::String_/*",),
        ("0/chatter/std_msgs::msg::dds_::String_/*",),
        ("0/rumor/std_msgs::msg::dds_::String_/*",),
    ]


def test_chunks_that_wildcards_leave_out_are_named():
    """`*` matches no chunk that begins with @."""
    assert keys_of(sent("a/@1/b"), sent("a/@2/b")) == [("a/@1/b", "a/@2/b")]


def test_no_pattern_has_more_wild_numbers_than_specs_may():
    """What differs more often is any chunk, or the keys stand as they are."""
    assert keys_of(sent("a1b2c3d4/pose"), sent("a5b6c7d8/pose")) == [("*/pose",)]
    found = keys_of(sent("r1/r1/r1/r1"), sent("r2/r2/r2/r2"), sent("a/a/a/a", POSE))
    assert found == [("a/a/a/a",), ("r1/r1/r1/r1", "r2/r2/r2/r2")]


def test_words_tell_what_it_is():
    """Those after the last chunk that differs; without any, the last one."""
    (kind,) = kinds_of(streams_of(sent("robot/r1/arm/front"), sent("robot/r2/arm/front")))
    assert (kind.words, kind.telling) == (("robot", "arm", "front"), 2)
    (kind,) = kinds_of(streams_of(sent("robot/r1/arm")))
    assert (kind.words, kind.telling) == (("robot", "r1", "arm"), 1)
    (kind,) = kinds_of(streams_of(sent(f"0/r1/odom/{STRING}"), sent(f"0/r2/odom/{STRING}")))
    assert (kind.words, kind.telling) == (("odom",), 1)


def test_one_key_is_of_one_kind():
    """Whoever publishes it, and whatever."""
    assert keys_of(sent("map"), sent("map", POSE, 20.0)) == [("map",)]
    assert keys_of(sent("r/1"), sent("r/2", POSE), sent("r/2")) == [("r/1",), ("r/2",)]


def test_more_keys_than_a_type_may_have_yield_to_others():
    """Their pattern covers others as well, so these must come first."""
    ids = [sent(f"r/{number:08x}a", seconds=2.0) for number in range(MOST_KEYS + 1)]
    kinds = {kind.keys: kind for kind in kinds_of(streams_of(*ids, sent("r/pose", POSE)))}
    assert set(kinds) == {("r/*",), ("r/pose",)}
    assert (kinds["r/*",].yields, kinds["r/pose",].yields) == (True, False)
    assert named(list(kinds.values()))[-1].kind.yields


CHUNKS = st.lists(st.sampled_from(["a", "b", "r1", "r2", "@x", "7", "0123abcd"]), min_size=1, max_size=4)


@given(st.lists(CHUNKS, min_size=1, max_size=12), st.sets(st.sampled_from(["a", "r1"])))
def test_every_stream_is_covered_by_its_kind_alone(all_chunks, robots):
    """Whatever the keys are."""
    streams = streams_of(*(sent("/".join(each), [BATTERY, POSE][len(each) % 2], seconds=2.0) for each in all_chunks))
    kinds = kinds_of(streams, robots)
    assert sorted(stream.key for kind in kinds for stream in kind.streams) == sorted(stream.key for stream in streams)
    for kind in kinds:
        assert len(kind.keys) <= MOST_KEYS
        for stream in streams:
            covers = any(zenoh.KeyExpr(KeyFormat.parse(key).expression).includes(stream.key) for key in kind.keys)
            assert covers == (stream in kind.streams)
