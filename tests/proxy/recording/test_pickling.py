"""What a core is taken apart into, and what cannot be."""

import gc

import pytest

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from proxy.recording.errors import RecordingError
from proxy.recording.pickling import part, pickled, view
from utility_specs import Specs


class Foreign:
    """Is no part of a core."""


@pytest.fixture
def core():
    return Core(CoreSettings("r1", "z1"), Specs.empty(), 1.0)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (lambda: None, "PicklingError: Can't pickle <function"),
        (gc.collect, "a snapshot has no builtins.builtin_function_or_method"),
        (Foreign(), "a snapshot has no tests.proxy.recording.test_pickling.Foreign"),
        (object(), "a snapshot has no builtins.object"),
        ((each for each in ()), "a snapshot has no builtins.generator"),
        (RecordingError("x"), "a snapshot has no proxy.recording.errors.RecordingError"),
    ],
)
def test_what_would_not_be_read_is_not_written(core, value, message):
    """It is found where the snapshot is taken, not where somebody needs it."""
    core.unknown = [value]
    with pytest.raises(RecordingError, match=message):
        pickled(core)
    assert gc.isenabled()


def test_what_has_not_all_of_its_fields_is_not_written(core):
    """Nor what is too deep."""
    deep = []
    for _ in range(100_000):
        deep = [deep]
    core.unknown = deep
    with pytest.raises(RecordingError, match="RecursionError"):
        pickled(core)


def test_garbage_is_left_as_it_was(core):
    """Whoever had it collected or not."""
    gc.disable()
    try:
        pickled(core)
        assert not gc.isenabled()
    finally:
        gc.enable()


@pytest.mark.parametrize("word", [part, view])
def test_words_of_snapshots_do_nothing(word):
    """They are only ever named."""
    with pytest.raises(NotImplementedError, match="only a snapshot has"):
        word(1)
