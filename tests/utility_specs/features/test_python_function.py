"""Features that a function of the operator's computes."""

import pytest
from pydantic import ValidationError

from utility_specs.features.python_function import PythonFunctionTable
from utility_specs.features.sample import Sample


def letters(key: str, payload: bytes) -> int:
    return len(key) + payload.count(b"a")


def test_the_function_gets_key_and_payload():
    """And what it returns is the feature."""
    table = PythonFunctionTable(kind="python", function=f"{__name__}:letters", default=2.0)
    feature = table.feature()
    assert feature.measure(Sample("k/1", b"banana")) == 6.0
    assert (feature.default, feature.reads_payload) == (2.0, True)


def test_a_function_that_is_not_there_is_refused():
    """When the spec is loaded."""
    with pytest.raises(ValidationError, match="did you mean"):
        PythonFunctionTable(kind="python", function=f"{__name__}:leters")
