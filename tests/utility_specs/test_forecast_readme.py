"""The manual of forecasts: every example in it is a spec."""

import re
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from utility_specs import load_specs
from utility_specs.forecast import AnyMethod
from utility_specs.schedules import PythonRule
from utility_specs.schema import SpecFile

README = (Path(__file__).parents[2] / "utility_specs" / "README.md").read_text()
MANUAL = README[README.index("## `forecast`") :]
SCHEDULES, FEATURES = MANUAL.split("### What:")


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load a type with this forecast; the functions of the manual are in the module `mission`."""
    (tmp_path / "mission.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", MANUAL, re.DOTALL)))
    monkeypatch.syspath_prepend(tmp_path)

    def load_type(line):
        text = '[[information_type]]\nname = "x"\nkeys = ["x"]\nutility = { kind = "video" }\n'
        features = "features.red = { kind = 'size' }\nfeatures.size = { kind = 'size' }\n"
        (tmp_path / "x.toml").write_text(f"{text}{features}{line}\n")
        return load_specs(tmp_path / "x.toml").types[0]

    return load_type


@pytest.mark.parametrize("row", re.findall(r"^\| .*? \| `([^`]*?)` \|$", SCHEDULES, re.MULTILINE)[1:])
def test_every_schedule_in_the_table_loads(load, row):
    """As it is written there."""
    rule = load(f"forecast.schedule = {row}").schedule
    assert type(rule).__name__.removesuffix("Rule").lower() in row or (rule is None and row == '"auto"')


@pytest.mark.parametrize("row", re.findall(r"^\| .*? \| `([^`]*?)` \|$", FEATURES, re.MULTILINE)[1:])
def test_every_forecast_of_features_in_the_table_loads(load, row):
    """As it is written there."""
    assert load(f"forecast.features = {row}").forecast.plain == (row == '"last"')


def test_no_kind_is_missing():
    """The tables have a row for each kind of the schema."""
    table = SpecFile.model_json_schema()["$defs"]["ForecastTable"]["properties"]["schedule"]["oneOf"][1]
    assert set(re.findall(r'kind = "(\w+)"', SCHEDULES)) == set(table["discriminator"]["mapping"])
    names = TypeAdapter(AnyMethod).json_schema()["oneOf"][0]["enum"]
    assert set(re.findall(r'\| `"(\w+)"` \|', FEATURES)) == set(names)


def test_the_functions_do_what_they_say(load):
    """Times ahead, and a value that fades."""
    covering = load('forecast = { features = { red = { python = "mission:next_red" } }, '
                    'schedule = { kind = "python", function = "mission:next_times" } }')  # fmt: skip
    assert isinstance(covering.schedule, PythonRule)
    assert covering.schedule.next_times([0.0, 2.0, 4.0], 16.0) == [6.0, 11.0, 13.0, 15.0]
    (method,) = covering.forecast.of("red")
    assert method.predict([0.0, 1.0], [3.0, 4.0], 3.0) == pytest.approx(2.0)
