"""What specs say besides worth and limits, as the daemon gets it."""

import pytest

from tests.utility_specs.bad_specs import GOOD
from utility_specs import SpecsError, load_specs
from utility_specs.loader import load_set
from utility_specs.rules import FALLBACK, FLOOR, Fallback, Guarantee

RULES = """\
mode = "shadow"
bypass = true
min_rate = "2 Hz"
max_age = "5 s"
deletes = "decide"
queries = "drop"
"""


def load(tmp_path, text, name="spec"):
    (tmp_path / f"{name}.toml").write_text(text)
    return load_specs(tmp_path)


def test_rules_of_a_type_arrive_as_they_are_written(tmp_path):
    """And change the generation."""
    (camera,) = load(tmp_path, GOOD + RULES).types
    assert (camera.mode, camera.bypass, camera.deletes, camera.queries) == ("shadow", True, "decide", "drop")
    assert camera.guarantee == Guarantee(2.0, 5.0)
    assert not camera.planned
    assert load(tmp_path, GOOD + RULES).generation != load(tmp_path, GOOD).generation


def test_without_rules_everything_is_planned(tmp_path):
    """Deletes and queries pass, nothing is guaranteed, the mode is the daemon's."""
    specs = load(tmp_path, GOOD)
    (camera,) = specs.types
    assert (camera.mode, camera.bypass, camera.deletes, camera.queries) == (None, False, "bypass", "pass")
    assert camera.guarantee == Guarantee()
    assert camera.planned
    assert (specs.fallback, specs.floor, specs.modes) == (FALLBACK, FLOOR, {None})


@pytest.mark.parametrize(
    ("guarantee", "rate"), [((None, None), 0.0), ((2.0, None), 2.0), ((None, 4.0), 0.25), ((1.0, 0.5), 2.0)]
)
def test_a_guarantee_takes_so_many_samples(guarantee, rate):
    """The one that takes more counts."""
    assert Guarantee(*guarantee).rate == rate


def test_rules_of_all_files_are_those_of_the_one_that_has_them(tmp_path):
    """Floor and static rule may stand in any file, and change the generation."""
    load(tmp_path, GOOD)
    specs = load(tmp_path, 'floor = "25 %"\nfallback = { urgent = "real_time", part = 0.25 }\n', "rules")
    assert (specs.floor, specs.fallback) == (0.25, Fallback(1, 0.25))
    other = load(tmp_path, 'floor = "20 %"\nfallback = { urgent = "real_time", part = 0.25 }\n', "rules")
    assert specs.generation != other.generation


def test_rules_that_are_set_twice_are_refused(tmp_path):
    """Nobody could tell which of them holds."""
    (tmp_path / "a.toml").write_text("floor = 0.1\n" + GOOD)
    (tmp_path / "b.toml").write_text("fallback = {}\nfloor = 0.1\n")
    (tmp_path / "c.toml").write_text("fallback.part = 0.1\n")
    with pytest.raises(SpecsError) as caught:
        load_set([tmp_path])
    assert [str(problem) for problem in caught.value.problems] == [
        f"{tmp_path}/b.toml:2: floor: is already set at {tmp_path}/a.toml:1, for all files",
        f"{tmp_path}/c.toml:1: fallback: is already set at {tmp_path}/b.toml:1, for all files",
    ]
