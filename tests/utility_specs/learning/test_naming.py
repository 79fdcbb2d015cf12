"""Names for what was found."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from utility_specs.learning.naming import feature_name, type_name
from utility_specs.names import Name
from utility_specs.schema import FeatureName


@pytest.mark.parametrize(
    ("words", "telling", "taken", "name"),
    [
        (("robot", "camera"), 1, (), "camera"),
        (("robot", "arm", "camera"), 2, (), "arm_camera"),
        (("robot", "arm", "camera"), 1, ("camera",), "arm_camera"),
        (("camera",), 1, ("camera",), "camera_1"),
        (("camera",), 1, ("camera", "camera_1"), "camera_2"),
        ((), 1, (), "stream_1"),
        (("täst", "?"), 1, (), "t_st"),
        (("std::String",), 1, (), "std_String"),
    ],
)
def test_types_have_the_last_words_of_their_keys(words, telling, taken, name):
    """As many as it takes to be no other."""
    assert type_name(words, telling, taken) == name


@pytest.mark.parametrize(
    ("path", "suffix", "taken", "name"),
    [
        ("battery.charge", "", (), "charge"),
        ("battery.charge", "", ("charge",), "battery_charge"),
        ("p[1]", "", (), "p_1"),
        ("ranges", "min", (), "ranges_min"),
        ("", "", (), "value_1"),
        ("min", "", (), "min_1"),
        ("pose.e", "", (), "pose_e"),
        ('["1a"]', "", (), "v1a"),
        ("state", "low battery!", (), "state_low_battery"),
        ("charge", "", ("charge",), "charge_1"),
    ],
)
def test_features_have_the_last_names_of_their_paths(path, suffix, taken, name):
    """What expressions can use."""
    assert feature_name(path, suffix, taken) == name


@given(st.lists(st.text(max_size=70), max_size=3), st.integers(0, 3), st.text(max_size=70), st.text(max_size=70))
def test_any_name_is_one(words, telling, path, suffix):
    """Whatever the keys and paths."""
    try:
        TypeAdapter(Name).validate_python(type_name(words, telling, ()))
        TypeAdapter(FeatureName).validate_python(feature_name(path, suffix, ()))
    except ValidationError as error:
        raise AssertionError(str(error)) from None
    assert feature_name(path, suffix, (feature_name(path, suffix, ()),)) != feature_name(path, suffix, ())
