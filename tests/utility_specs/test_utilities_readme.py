"""The manual of utilities and aggregations: every example in it is a spec."""

import re
from pathlib import Path

import pytest

from planner import Aggregation, AggregationModel
from utility_specs import load_specs
from utility_specs.schema import SpecFile

README = (Path(__file__).parents[2] / "utility_specs" / "README.md").read_text()


def blocks(language):
    manual = README[README.index("## `[[constraint]]`") :]  # what stands before has tests of its own
    return re.findall(rf"```{language}\n(.*?)```", manual, re.DOTALL)


def spec(line) -> str:
    return f'[[information_type]]\nname = "x"\nkeys = ["x"]\n{line}\n'


@pytest.mark.parametrize("row", re.findall(r"^\| `(\{ kind = .*?\})` \|", README, re.MULTILINE))
def test_every_kind_in_the_table_loads(row, tmp_path, monkeypatch):
    """As it is written there."""
    (tmp_path / "worth.py").write_text(blocks("python")[0])
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "x.toml").write_text(spec(f"utility = {row}\nfeatures.red = {{ kind = 'size' }}"))
    (loaded,) = load_specs(tmp_path / "x.toml").types
    assert f'kind = "{kind(loaded.utility)}"' in row


def kind(utility) -> str:
    name = type(utility).__name__.lower()
    return "python" if name == "custom" else name


def test_no_kind_is_missing():
    """The table has a row for each kind of the schema."""
    mapping = SpecFile.model_json_schema()["$defs"]["InformationTypeTable"]["properties"]["utility"]["discriminator"]
    assert set(re.findall(r'kind = "(\w+)"', README)) >= set(mapping["mapping"])


def test_the_spec_with_a_function_loads(tmp_path, monkeypatch):
    """The function and the spec that names it fit together."""
    (tmp_path / "worth.py").write_text(blocks("python")[0])
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "x.toml").write_text(blocks("toml")[1])
    (camera,) = load_specs(tmp_path / "x.toml").types
    assert camera.utility_of({"red": 0.5}) != camera.utility


@pytest.mark.parametrize("row", re.findall(r"^\| `(\"\w+\"|\{ python = .*?\})` \|", README, re.MULTILINE))
def test_every_aggregation_in_the_table_loads(row, tmp_path, monkeypatch):
    """As it is written there."""
    (tmp_path / "soundings.py").write_text(blocks("python")[1])
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "x.toml").write_text(spec(f"utility = {{ kind = 'video' }}\naggregation = {row}"))
    (loaded,) = load_specs(tmp_path / "x.toml").types
    assert row in (f'"{loaded.aggregation}"', f'{{ python = "soundings:{type(loaded.aggregation).__name__}" }}')
    assert loaded.markovian == (row in ('"most_recent"', '"current"'))


def test_no_aggregation_is_missing():
    """The table has a row for each of the planner's."""
    assert set(re.findall(r'^\| `"(\w+)"` \|', README, re.MULTILINE)) == set(Aggregation)


def test_the_spec_with_a_class_loads(tmp_path, monkeypatch):
    """The class and the spec that names it fit together."""
    (tmp_path / "soundings.py").write_text(blocks("python")[1])
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "x.toml").write_text(blocks("toml")[2])
    (soundings,) = load_specs(tmp_path / "x.toml").types
    assert isinstance(soundings.aggregation, AggregationModel)


def test_the_spec_of_an_adaptive_limit_loads(tmp_path):
    """As it stands there."""
    (tmp_path / "x.toml").write_text(spec("utility = { kind = 'video' }") + blocks("toml")[0])
    assert load_specs(tmp_path / "x.toml").constraints[-1].least == pytest.approx(0.2 / 6.0)
