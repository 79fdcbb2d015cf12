"""The manual of keys, expressions and rules: every example in it is a spec, and does what it says."""

import re
from pathlib import Path

import pytest

from utility_specs import load_specs
from utility_specs.check import Report
from utility_specs.competing import competitors, typical_sizes
from utility_specs.explaining import explain
from utility_specs.loader import load_set

README = (Path(__file__).parents[2] / "utility_specs" / "README.md").read_text()
SECTIONS = README[README.index("## `keys`") : README.index("## `[[constraint]]`")]
TYPE = '[[information_type]]\nname = "x"\nkeys = ["x"]\nutility = { kind = "video" }\n'


def load(tmp_path, text):
    (tmp_path / "spec.toml").write_text(text)
    return load_specs(tmp_path)


@pytest.mark.parametrize(
    ("example", "key", "features", "scale"),
    [
        (0, "robot/leader/camera/3", {}, 0.5),
        (0, "robot/r2/camera/3", {}, 0.25),
        (1, "robot/r1/camera", {"red": 0.5, "size": 6e5}, 3.0),
        (1, "robot/r1/camera", {"red": 0.5, "size": 4e5}, 6.0),
    ],
)
def test_the_examples_are_specs(tmp_path, example, key, features, scale):
    """With the values that one expects."""
    text = re.findall(r"```toml\n(.*?)```", SECTIONS, re.DOTALL)[example]
    assert load(tmp_path, text).match(key).scale(features) == scale


@pytest.mark.parametrize("row", re.findall(r"^\| `(\w+ = .*?)` \|", SECTIONS, re.MULTILINE))
def test_every_rule_in_the_tables_loads(tmp_path, row):
    """As it is written there; those of a file stand before its tables."""
    of_a_file = row.startswith(("floor", "fallback"))
    assert load(tmp_path, f"{row}\n{TYPE}" if of_a_file else f"{TYPE}{row}\n").types


def test_the_line_for_editors_is_a_comment(tmp_path):
    """To the loader."""
    (line,) = re.findall(r"```toml\n(#:schema .*?)```", README, re.DOTALL)
    assert load(tmp_path, line + TYPE).types


def test_the_first_example_is_a_whole_spec_without_a_warning(tmp_path):
    """Of all four types; `sendworthy explain` says of a low battery what the text promises: much for its bytes."""
    text = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)[0]
    (tmp_path / "robot.toml").write_text(text)
    report = Report.on([tmp_path / "robot.toml"])
    assert (report.errors, report.warnings) == ((), ())
    specs = load_set([tmp_path / "robot.toml"])
    key, payload = re.findall(r"robot.toml (\S+) --text '(.*?)'", README)[0]
    explanation = explain(specs, key, payload.encode())
    assert explanation.worth.scale.value == 5.0
    ranked = [each.name for each in competitors(specs, explanation, typical_sizes(specs))]
    assert ranked == ["alarm", "battery", "pose", "camera"]
