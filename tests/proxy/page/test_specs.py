"""Specs as the page has them."""

import tempfile

import pytest

from proxy.errors import PushError
from proxy.page.specs import InForce, checked
from tests.pages import SPECS


def test_mistakes_are_told_with_file_and_line_and_no_place_of_this_machine():
    """As `sendworthy check` finds them; warnings are none."""
    found = checked({"a.toml": SPECS.format(limit="much"), "b.toml": "oops = ["})
    assert not found["fit"]
    assert {(each["file"], each["line"]) for each in found["errors"]} == {("a.toml", 3), ("b.toml", 1)}
    assert "/tmp" not in str(found)  # noqa: S108 - where it is checked
    unused = SPECS.format(limit="1 Mbit/s").replace('scale = "1 + 10 * red"\n', "")
    found = checked({"a.toml": unused})
    assert found["fit"]
    assert [each["file"] for each in found["warnings"]] == ["a.toml"]


def test_specs_that_are_not_understood_here_are_said_to_be_so():
    """They may need what only robots have; without files there are none."""
    found = InForce.of("g", {"a.toml": SPECS.format(limit="much")})
    assert found.files
    assert not found.specs.types
    assert "a.toml:3" in found.problem
    assert InForce.of("g", {"../a": ""}).problem
    assert InForce.of("g", {}) == InForce("g")


def test_where_no_file_can_be_written_that_is_said_and_no_fault_of_the_specs(monkeypatch, tmp_path):
    """As where /tmp is full: they may be understood later."""
    files = {"a.toml": SPECS.format(limit="1 Mbit/s")}
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
    why = "specs cannot be looked at here: No such file or directory"
    with pytest.raises(PushError) as refused:
        checked(files)
    assert str(refused.value) == why
    assert InForce.of("g", files) == InForce("g", files, problem=why, passing=True)
    monkeypatch.undo()
    assert InForce.of("g", files).specs.types
