"""The manual of features: every example in it is a spec."""

import re
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from utility_specs import load_specs
from utility_specs.features import AnyFeatureTable
from utility_specs.features.pixels import ENCODINGS

README = (Path(__file__).parents[2] / "utility_specs" / "README.md").read_text()
MANUAL = README[README.index("## `features`") : README.index("## `forecast`")]
ROWS = re.findall(r"^\| .*? \| `(\{.*?\})` \|$", MANUAL, re.MULTILINE)


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load a spec; the function of the manual is in the module `reports`."""
    (tmp_path / "reports.py").write_text(re.findall(r"```python\n(.*?)```", MANUAL, re.DOTALL)[0])
    monkeypatch.syspath_prepend(tmp_path)

    def load_type(text):
        (tmp_path / "x.toml").write_text(text)
        return load_specs(tmp_path / "x.toml").types[0]

    return load_type


@pytest.mark.parametrize("row", ROWS)
def test_every_feature_in_the_table_loads(load, row):
    """As it is written there."""
    head = '[[information_type]]\nname = "x"\nkeys = ["x"]\nutility = { kind = "video" }\nscale = "x"\n'
    assert load(f"{head}features.x = {row}\n").features[0][0] == "x"


def test_no_kind_and_no_encoding_is_missing():
    """The table has a row for each kind of the schema, the text a word for each encoding."""
    kinds = TypeAdapter(AnyFeatureTable).json_schema()["discriminator"]["mapping"]
    assert {kind for row in ROWS for kind in re.findall(r'kind = "(\w+)"', row)} == set(kinds)
    assert set(re.findall(r"`(\w+)`", MANUAL)) >= set(ENCODINGS)


def test_the_spec_with_a_function_loads(load):
    """The function and the spec that names it fit together."""
    report = load(re.findall(r"```toml\n(.*?)```", MANUAL, re.DOTALL)[0])
    assert report.scale(report.extract("robot/r1/report", b"two words")) == pytest.approx(1.02)
