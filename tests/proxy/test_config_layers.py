"""Variables and flags on top of the file."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.config_layers import Layers, Override, deep_merge, flags, leaves, read_value, variables

keys = st.text("abc", min_size=1, max_size=2)
trees = st.recursive(
    st.dictionaries(keys, st.integers(), max_size=3),
    lambda inner: st.dictionaries(keys, inner | st.integers()),
)


def test_variables_are_nested_by_double_underscores():
    """Only what starts with our prefix counts; a single underscore belongs to a name."""
    environ = {"SENDWORTHY_MESH__ZENOH__CONNECT__TIMEOUT_MS": "5", "HOME": "/root", "SENDWORTHY_ROBOT": "r1"}
    assert list(variables(environ)) == [
        Override(("mesh", "zenoh", "connect", "timeout_ms"), "5", "SENDWORTHY_MESH__ZENOH__CONNECT__TIMEOUT_MS"),
        Override(("robot",), "r1", "SENDWORTHY_ROBOT"),
    ]


def test_flags_are_nested_by_dots():
    """A flag's name is the key."""
    assert list(flags({"planner.iterations": "5"})) == [
        Override(("planner", "iterations"), "5", "--planner.iterations")
    ]


@pytest.mark.parametrize(
    ("text", "takes_text", "value"),
    [
        ("500", False, 500),
        ("0.5", False, 0.5),
        ("true", False, True),
        ('["a", "b"]', False, ["a", "b"]),
        ("{ a.b = 1 }", False, {"a": {"b": 1}}),
        ("maybe", False, "maybe"),
        ("1" * 5000, False, "1" * 5000),
        ("[" * 5000, False, "[" * 5000),
        ("", False, ""),
        ("7", True, "7"),
        ('"7"', True, "7"),
        ("r1", True, "r1"),
        ("2026-01-01", True, "2026-01-01"),
        ("1\nother = 2", False, "1\nother = 2"),
        ("1\nother = 2", True, "1\nother = 2"),
    ],
)
def test_values_are_toml_or_text(text, takes_text, value):
    """What is one TOML value is that; everything else, and everything for a text setting, is text."""
    assert read_value(text, takes_text=takes_text) == value


@given(trees, trees)
def test_merging_keeps_everything_that_is_not_overridden(under, over):
    """Each leaf of the upper tree is there, unless the lower tree has no table where one is needed."""
    merged = deep_merge(under, over)
    for path in leaves(over, ()):
        node, below = merged, under
        for key in path:
            blocked = isinstance(below, dict) and key in below and not isinstance(below[key], dict)
            node, below = node[key], below.get(key, {}) if isinstance(below, dict) else {}
            if blocked:
                break
    assert set(under) | set(over) == set(merged)


@given(trees)
def test_merging_with_nothing_changes_nothing(tree):
    """An empty layer is no layer."""
    assert deep_merge(tree, {}) == tree
    assert deep_merge({}, tree) == tree


def test_an_inner_override_does_not_hide_a_mistake_of_the_file():
    """Where the file has a number in place of a table, the number stays, to be reported."""
    assert deep_merge({"mesh": 3}, {"mesh": {"scouting": False}}) == {"mesh": 3}


def test_origin_is_the_override_that_set_the_value():
    """The items of a list come from where the list comes from; the rest comes from the file."""
    layers = Layers({"mesh": {"scouting": True}})
    layers.put(Override(("mesh", "connect"), '["a"]', "--mesh.connect"), takes_text=False)
    layers.put(Override(("mesh", "zenoh"), "{ a.b = 1 }", "SENDWORTHY_MESH__ZENOH"), takes_text=False)
    assert layers.values == {"mesh": {"scouting": True, "connect": ["a"], "zenoh": {"a": {"b": 1}}}}
    assert layers.origin(("mesh", "connect", 0)) == "--mesh.connect"
    assert layers.origin(("mesh", "zenoh", "a", "b")) == "SENDWORTHY_MESH__ZENOH"
    assert layers.origin(("mesh", "scouting")) is None
    assert layers.origin(("mesh",)) is None


def test_the_later_override_is_the_origin():
    """A flag that sets what a variable has set is the one to blame."""
    layers = Layers({})
    layers.put(Override(("planner", "horizon"), "1", "SENDWORTHY_PLANNER__HORIZON"), takes_text=False)
    layers.put(Override(("planner", "horizon"), "0", "--planner.horizon"), takes_text=False)
    assert layers.values == {"planner": {"horizon": 0}}
    assert layers.origin(("planner", "horizon")) == "--planner.horizon"
