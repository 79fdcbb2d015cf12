"""Specs from a recording."""

import pytest

from proxy.recording.entries import SpecFile, SpecsText
from proxy.recording.errors import RecordingError
from proxy.recording.output import text_of
from studies.replay.specs import specs_of
from utility_specs import Specs, load_specs

ONE = '[[information_type]]\nname = "NAME"\nkeys = ["a/**"]\nutility = { kind = "video" }\n'


def test_specs_come_back_as_they_were_read(tmp_path):
    """Of several files in their order, for the first type that covers a key holds."""
    for name in ("b", "a"):
        (tmp_path / f"{name}.toml").write_text(ONE.replace("NAME", name))
    specs = load_specs(tmp_path)
    again = specs_of(text_of(specs))
    assert again.generation == specs.generation
    assert [each.name for each in again.types] == ["a", "b"]


def test_no_specs_are_specs_too():
    """A daemon without any passes everything."""
    assert specs_of(text_of(Specs.empty())).types == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SpecsText("abc"), "the text of the specs abc is not in the recording"),
        (SpecsText("abc", (SpecFile("a.toml", ONE),)), "mean something else in this version"),
        (SpecsText("abc", (SpecFile("../a.toml", "x = 1"),)), r"cannot be read here: 0000/a.toml:1: x: unknown key"),
    ],
)
def test_what_cannot_be_put_together_is_refused(text, message):
    """With the reason."""
    with pytest.raises(RecordingError, match=message):
        specs_of(text)
