"""Specs from a recording."""

import sys

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


PYTHON = {
    "a feature": 'features.x = { kind = "python", function = "called_by:f" }\nutility = { kind = "video" }',
    "a utility": 'utility = { kind = "python", function = "called_by:f", until = "1 s" }',
    "an aggregation": 'utility = { kind = "video" }\naggregation = { python = "called_by:C" }',
    "a schedule": 'utility = { kind = "video" }\nforecast.schedule = { kind = "python", function = "called_by:f" }',
    "a forecast": 'utility = { kind = "video" }\nforecast.features = { python = "called_by:f" }',
}
CALLED_BY = """
import pathlib
pathlib.Path(__file__).with_name("ran").touch()
def f(*_): raise RuntimeError
class C:
    def empty(self): return 0
    def add(self, state, *_): return state
    def value(self, *_): return 0.0
"""


@pytest.mark.parametrize("spec", PYTHON.values(), ids=PYTHON.keys())
def test_python_of_a_recording_runs_only_where_that_is_wanted(spec, tmp_path, monkeypatch):
    """Whoever sent it may name any function that there is here, and call it with payloads of his."""
    (tmp_path / "called_by.py").write_text(CALLED_BY)
    monkeypatch.syspath_prepend(tmp_path)
    text = f'[[information_type]]\nname = "a"\nkeys = ["a/**"]\n{spec}\n'
    hostile = SpecsText("abc", (SpecFile("a.toml", text),))
    with pytest.raises(RecordingError, match=r'"called_by:\w" is not imported: a recording may come from anybody'):
        specs_of(hostile)
    assert not (tmp_path / "ran").exists()
    monkeypatch.delitem(sys.modules, "called_by", raising=False)
    with pytest.raises(RecordingError):  # it is no Python that serves any purpose
        specs_of(hostile, python=True)
    assert (tmp_path / "ran").exists()
