"""CONTRIBUTING.md and the daemon's README say where things stand: the files they name are there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
QUESTIONS = ("A new kind of constraint", "A new aggregation", "A new field of a digest", "A new command")
NAMED = re.compile(r"`([\w/]+(?:/|\.(?:py|md|toml)))`")
PLACES = ("", "proxy", "proxy/core", "proxy/bridge", "proxy/commands", "tests")


def answers():
    """What CONTRIBUTING.md says of each question, by question."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    found = re.split(
        r"^\*\*(A new [^*]+)\*\*", text.split("## Where new things go")[1].split("\n## ")[0], flags=re.MULTILINE
    )
    return dict(zip(found[1::2], found[2::2], strict=True))


@pytest.mark.parametrize("question", QUESTIONS)
def test_it_is_said_where_a_new_thing_goes(question):
    """Each answer names files that are there, and a test among them."""
    named = NAMED.findall(answers()[question])
    assert [path for path in named if not (ROOT / path).exists()] == []
    assert any(path.startswith("tests/") for path in named)


def test_the_files_that_the_readme_of_the_daemon_names_are_there():
    """By their paths in the repository, the daemon's room, its core or its bridge."""
    named = set(NAMED.findall((ROOT / "proxy" / "README.md").read_text()))
    assert named
    missing = [path for path in named if not any((ROOT / place / path).exists() for place in PLACES)]
    assert not [path for path in missing if path != "tuning.py"]  # one in each package
