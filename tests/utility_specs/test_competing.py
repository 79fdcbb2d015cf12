"""What samples of different kinds are worth by byte."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.competing import Competitor, competitors, ranked, typical_sizes
from utility_specs.explaining import explain
from utility_specs.loader import load_set

SPECS = """\
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "step", lifetime = "10 s" }
scale = "1 + red"
features.red = { kind = "json", path = "red", default = 1.0 }
forecast = { size = "40 kB" }

[[information_type]]
name = "pose"
keys = ["robot/${robot:*}/pose/${n:*}"]
utility = { kind = "step", lifetime = "500 ms" }
scale = "n"

[[information_type]]
name = "stop"
keys = ["robot/*/stop"]
utility = { kind = "step", lifetime = "500 ms" }
bypass = true
forecast = { size = "50 B" }

[[information_type]]
name = "log"
keys = ["robot/*/log"]
utility = { kind = "step", lifetime = "1 s" }
mode = "pass"
"""


@pytest.fixture(scope="module")
def specs(tmp_path_factory):
    """Four types."""
    file = tmp_path_factory.mktemp("specs") / "specs.toml"
    file.write_text(SPECS)
    return load_set([file])


def test_a_sample_stands_among_typical_ones_of_other_types(specs):
    """The worthiest by byte first; the sample itself with what it shows, the others by default."""
    found = competitors(specs, explain(specs, "robot/r1/camera", b'{"red": 3}'), typical_sizes(specs))
    assert [(each.name, each.value, each.size, each.this, each.note) for each in found] == [
        ("camera", 4.0, 10, True, ""),
        ("stop", 0.5, 50.0, False, "bypasses the planner"),
        ("pose", None, None, False, "worth depends on the key, size not known"),
        ("log", 1.0, None, False, "always passes, size not known"),
    ]
    assert found[0].per_kilobyte == 400.0
    assert found[0].data()["per_kilobyte"] == 400.0


def test_sizes_can_be_given(specs):
    """Of types that say none."""
    stop = explain(specs, "robot/r1/stop", b"x")
    found = competitors(specs, stop, typical_sizes(specs) | {"log": 1.0})
    assert [each.name for each in found] == ["log", "stop", "camera", "pose"]


def test_what_no_type_covers_is_not_among_them(specs):
    """It competes with nothing, but takes from all."""
    found = competitors(specs, explain(specs, "other", b"x"), {})
    assert {each.name for each in found} == {"camera", "pose", "stop", "log"}
    assert not any(each.this for each in found)


sizes = st.none() | st.floats(0.0, 1e9)


@given(st.lists(st.builds(Competitor, st.just("a"), sizes, sizes)))
def test_the_order_is_by_worth_and_unknown_ones_are_last(found):
    """Whatever is not known, and with samples of no size."""
    values = [each.per_kilobyte for each in ranked(found)]
    known = [value for value in values if value is not None]
    assert known == sorted(known, reverse=True)
    assert values[: len(known)] == known
