"""From values in documents to numbers."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from utility_specs.features.document import JsonTable
from utility_specs.features.reading import Reading


def read(value, **said):
    return Reading((), **said).of(value)


@pytest.mark.parametrize(("value", "number"), [(True, 1.0), (False, 0.0), (3, 3.0), (2.5, 2.5), (np.float32(0.5), 0.5)])
def test_numbers_and_truth_are_numbers(value, number):
    """NumPy's included."""
    assert read(value) == number


@pytest.mark.parametrize("value", [None, "3", [3], {}, 10**400, np.array([1.0, 2.0])])
def test_all_else_is_none(value):
    """The caller then takes the default."""
    with pytest.raises((ValueError, OverflowError)):
        read(value)


@pytest.mark.parametrize(
    ("value", "equals", "number"),
    [("charging", "charging", 1.0), ("full", "charging", 0.0), (2, 2, 1.0), (None, "x", 0.0), (np.uint8(4), 4, 1.0)],
)
def test_a_value_may_be_compared(value, equals, number):
    """1 where it equals, 0 where it does not."""
    assert read(value, equals=equals) == number


@pytest.mark.parametrize("values", [[1, 2, 6.0, math.inf], np.array([1, 2, 6, math.nan], np.float32)])
@pytest.mark.parametrize(
    ("reduce", "number"), [("length", 4.0), ("min", 1.0), ("max", 6.0), ("mean", 3.0), ("sum", 9.0)]
)
def test_an_array_is_reduced(values, reduce, number):
    """Values that are not finite count for nothing but the length: a lidar says inf where it sees nothing."""
    assert read(values, reduce=reduce) == number


@pytest.mark.parametrize("values", [["a", "b", "a"], np.array([1, 2, 1]), [True, False, 1]])
def test_what_equals_is_counted(values):
    """`max` says whether there is one, `mean` which part."""
    equals = values[0]
    found = [read(values, equals=equals, reduce=reduce) for reduce in ("sum", "max", "mean")]
    assert found == [2.0, 1.0, 2.0 / 3.0]


@pytest.mark.parametrize("values", [[], (), np.array([])])
def test_of_nothing_nothing_equals(values):
    """There are 0 of it, and not any; a part of nothing there is not."""
    assert [read(values, equals="person", reduce=reduce) for reduce in ("sum", "max")] == [0.0, 0.0]
    for reduce in ("mean", "min"):
        with pytest.raises(ValueError, match="no numbers"):
            read(values, equals="person", reduce=reduce)


@pytest.mark.parametrize("value", [[], 3, "abc", {"a": 1}, [math.nan], ["a"], [[1]]])
def test_what_cannot_be_reduced_has_no_value(value):
    """Nothing is guessed."""
    with pytest.raises(ValueError, match=r"no numbers|not an array|not a number"):
        read(value, reduce="max")


def test_text_and_tables_have_a_length():
    """Of characters, of keys."""
    assert [read(value, reduce="length") for value in ("abc", {"a": 1}, [])] == [3.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"path": "a[*].b"}, "there are many values"),
        ({"path": "a", "reduce": "length", "equals": 1}, 'to count those that equal one, write "sum"'),
        ({"path": "a..b"}, "is not a path"),
        ({"path": "a", "equals": math.nan}, r"^1 validation error(?s:.)*must be finite, not nan"),
        ({"path": "a", "equals": -math.inf}, r"^1 validation error(?s:.)*must be finite, not -inf"),
        ({"path": "a", "equals": 2**64}, r"^1 validation error(?s:.)*must have 64 bits at most, not be a huge number"),
    ],
)
def test_a_table_that_makes_no_number_is_refused(table, message):
    """When the spec is loaded."""
    with pytest.raises(ValidationError, match=message):
        JsonTable.model_validate({"kind": "json"} | table)
