"""The sample configuration, which is the manual."""

import re
import tomllib
from pathlib import Path

import pytest

from proxy.config import Config, settings
from proxy.config_loading import load_config

SAMPLE = Path(__file__).parent.parent.parent / "deploy" / "sendworthy.toml"


@pytest.fixture
def uncommented(tmp_path):
    """The sample with every key switched on, beside a folder of specs."""
    (tmp_path / "specs.d").mkdir()
    file = tmp_path / "sendworthy.toml"
    file.write_text(re.sub(r"(?m)^#(?=\w)", "", SAMPLE.read_text()))
    return file


def test_the_sample_changes_nothing():
    """A daemon with the sample behaves like one without any file."""
    config = load_config(SAMPLE, {}, {})
    assert config.specs.path == SAMPLE.parent / "specs.d"
    assert config.record.folder == SAMPLE.parent / "recordings"
    elsewhere = {"specs": True, "record": {"folder"}}
    assert config.model_dump(exclude=elsewhere) == Config().model_dump(exclude=elsewhere)


def test_every_key_occurs_with_its_default(uncommented):
    """Whoever uncomments a key starts from what is in force anyway."""
    config = load_config(uncommented, {}, {})
    assert config.robot == "r1"
    assert config.specs.path == uncommented.parent / "specs.d"
    assert config.record.folder == uncommented.parent / "recordings"
    elsewhere = {"robot": True, "specs": True, "record": {"folder"}}
    assert config.model_dump(exclude=elsewhere) == Config().model_dump(exclude=elsewhere)
    written = tomllib.loads(uncommented.read_text())
    for setting in settings():
        node = written
        for part in setting.path:
            assert part in node, f"{setting.key} is not in the sample"
            node = node[part]


def test_every_key_is_explained():
    """A comment stands above each key."""
    lines = SAMPLE.read_text().splitlines()
    for number, line in enumerate(lines):
        if re.match(r"#\w", line):
            assert lines[number - 1].startswith("# "), f"line {number + 1}: {line} has no explanation"


def test_examples_within_comments_load(tmp_path):
    """The tables shown as examples are ones that Zenoh takes."""
    tables = re.findall(r"(?m)^#     (\[.*\.zenoh.*\])\n#     (.*)$", SAMPLE.read_text())
    assert len(tables) == 3
    file = tmp_path / "sendworthy.toml"
    file.write_text("\n".join(line for table in tables for line in table))
    config = load_config(file, {}, {})
    assert config.app.zenoh == {
        "transport": {"unicast": {"max_sessions": 50}, "shared_memory": {"enabled": True}},
    }
    assert config.mesh.zenoh == {"transport": {"link": {"tx": {"lease": 5000}}}}
