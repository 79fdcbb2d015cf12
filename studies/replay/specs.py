"""Specs from a recording, put together again as they were read."""

import tempfile
from contextlib import nullcontext
from pathlib import Path

from proxy.recording.entries import SpecsText
from proxy.recording.errors import RecordingError
from utility_specs import Specs, SpecsError
from utility_specs.imports import nothing_imported
from utility_specs.loader import load_set

NONE = Specs.empty()
REFUSAL = "a recording may come from anybody (`replay --python` runs what it names, --specs takes other specs)"


def specs_of(text: SpecsText, *, python: bool = False) -> Specs:
    """Return the specs of this text, with the `python` that they name, if it may run.

    Raises RecordingError where it has none, or means others here.
    """
    if text.generation == NONE.generation:
        return NONE
    if not text.files:
        raise RecordingError(f"the text of the specs {text.generation} is not in the recording")
    with tempfile.TemporaryDirectory(prefix="sendworthy-specs-") as folder:
        paths = []
        for number, file in enumerate(text.files):
            paths.append(Path(folder) / f"{number:04}" / (Path(file.name).name or "specs.toml"))
            paths[-1].parent.mkdir()
            paths[-1].write_text(file.text, encoding="utf-8")
        try:
            with nullcontext() if python else nothing_imported(REFUSAL):
                specs = load_set(paths).specs
        except SpecsError as error:
            problems = "; ".join(str(each).removeprefix(f"{folder}/") for each in error.problems)
            raise RecordingError(f"the specs {text.generation} cannot be read here: {problems}") from None
    if specs.generation != text.generation:
        raise RecordingError(f"the specs {text.generation} mean something else in this version: {specs.generation}")
    return specs
