"""A first spec from what was observed: the types of a team, and that any spec that is learned can be used."""

import re

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.problem import Aggregation
from planner.utility import Linear, Step, Video
from proxy.core.forecast.schedule import Schedule
from tests.utility_specs.features.scenes import checked, encoded, ros_compressed
from tests.utility_specs.features.test_cdr import battery
from tests.utility_specs.learning.team import PICTURES, json_bytes, regular, team
from utility_specs import load_specs
from utility_specs.learning import LearningError, Observed, learn
from utility_specs.schedules import PoissonRule

HASH = "RIHS01_df66"


def uncommented(text):
    """The spec with all that it proposes: lines that begin with # and no blank."""
    return re.sub(r"^#(?=\S)", "", text, flags=re.MULTILINE)


def loaded(text, folder):
    file = folder / "learned.toml"
    file.write_text(text)
    return load_specs(file)


def test_a_team_is_found_again(tmp_path):
    """Each kind of stream is a type, for all robots, with what suits how it comes."""
    specs = loaded(learn(team("r1", "r2", "r3"), Schedule), tmp_path)
    found = {each.name: (each.keys, type(each.utility), each.aggregation) for each in specs.types}
    assert found == {
        "camera": (("robot/*/camera",), Video, Aggregation.MOST_RECENT),
        "pose": (("robot/*/pose",), Linear, Aggregation.MOST_RECENT),
        "map": (("robot/*/map",), Step, Aggregation.ONCE),
        "battery": (("robot/*/battery",), Linear, Aggregation.MOST_RECENT),
        "alarm": (("robot/*/alarm",), Step, Aggregation.SUM),
    }
    assert all(each.weight == 1.0 and each.features == () for each in specs.types)
    (alarm,) = [each for each in specs.types if each.name == "alarm"]
    assert alarm.schedule is None or isinstance(alarm.schedule, PoissonRule)


def test_what_it_proposes_can_be_used(tmp_path):
    """Uncommented, features find in samples what was seen there."""
    samples = team("r1", "r2")
    specs = loaded(uncommented(learn(samples, Schedule)), tmp_path)
    features = {each.name: [name for name, _ in each.features] for each in specs.types}
    assert features["battery"] == ["state_low", "charge"]
    assert features["alarm"] == ["severity"]
    assert set(features["pose"]) == {"x", "yaw"}
    assert set(features["camera"]) >= {"red", "change"}
    for sample in samples:
        covering = specs.match(sample.key)
        assert covering.scale(covering.extract(sample.key, sample.payload)) <= 11.01
    assert all(not each.failures.counts() for each in specs.types)


def test_the_same_traffic_gives_the_same_spec():
    """To the letter."""
    assert learn(team("alice", "bob"), Schedule) == learn(team("alice", "bob"), Schedule)


def test_a_team_of_ros_is_found_by_its_types(tmp_path):
    """Keys of rmw_zenoh name what messages are; the configuration has a profile for them."""
    samples = []
    for name in ("r1", "r2"):
        key = f"0/{name}/battery/sensor_msgs::msg::dds_::BatteryState_/{HASH}"
        samples += regular(key, 1.0, lambda i: battery(1.0 - i / 100))
        key = f"0/{name}/image/sensor_msgs::msg::dds_::CompressedImage_/{HASH}"
        images = [ros_compressed(encoded(checked(0, grey))) for grey in (50, 250)]
        samples += regular(key, 2.0, lambda i, images=images: images[i // 5 % 2], 5.0)
    text = learn(samples, Schedule)
    specs = loaded(uncommented(text), tmp_path)
    assert {each.name: {name for name, _ in each.features} for each in specs.types} == {
        "battery": {"percentage"},
        "image": {"brightness", "change"},
    }
    assert specs.match(samples[0].key).extract(samples[0].key, samples[0].payload) == {"percentage": 1.0}
    assert 'profile = "ros2"' in text


def test_nothing_is_learned_from_nothing():
    """Nor from samples on keys that no spec can name."""
    with pytest.raises(LearningError, match="there are no samples to learn from"):
        learn([], Schedule)
    with pytest.raises(LearningError, match="there are no samples to learn from"):
        learn([Observed(0.0, "a//b", b"")], Schedule)


def test_what_was_left_out_is_said():
    """Samples on odd keys."""
    assert "# Left out: 1 of the samples, as no spec can name their keys." in learn(
        [Observed(0.0, "a//b", b""), Observed(0.0, "k", b"")], Schedule
    )


NAMES = st.text(max_size=8) | st.sampled_from(
    ["robot", "r1", "r2", "camera", "a.b", 'q"', "\\", "é", "min", "stamp", "#", "@a"]
)
KEYS = st.lists(NAMES, min_size=1, max_size=4).map("/".join)
NUMBERS = st.floats() | st.integers(-(2**63), 2**64 - 1) | st.booleans()
DOCUMENTS = st.recursive(
    NUMBERS | st.none() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=6) | st.dictionaries(NAMES, inner, max_size=4),
    max_leaves=8,
)
PAYLOADS = st.one_of(
    st.binary(max_size=30),
    st.sampled_from(PICTURES),
    DOCUMENTS.map(msgpack.packb),
    st.dictionaries(st.sampled_from(["x", "y"]), NUMBERS).map(msgpack.packb),
    st.dictionaries(st.sampled_from(["x", "y"]), st.floats(-2, 2)).map(lambda document: json_bytes(**document)),
)
SAMPLES = st.lists(
    st.builds(Observed, time=st.floats(-1e12, 1e12) | st.floats(0, 30), key=KEYS, payload=PAYLOADS), max_size=25
)


@settings(max_examples=40, deadline=None)
@given(SAMPLES, st.sets(NAMES, max_size=2))
def test_whatever_comes_what_is_learned_loads(tmp_path_factory, samples, robots):
    """Whatever the keys, payloads and times are, as it stands and with all that it proposes."""
    folder = tmp_path_factory.mktemp("learned")
    samples = [*samples, Observed(1.0, "k", b"x")]
    text = learn(samples, Schedule, sorted(robots))
    specs = loaded(text, folder)
    loaded(uncommented(text), folder)
    keys = {sample.key for sample in samples if specs.match(sample.key)}
    assert "k" in keys
