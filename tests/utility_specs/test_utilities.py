"""Tables of message utilities, and the planner's functions that they stand for."""

import pytest
from pydantic import TypeAdapter, ValidationError

from planner import Custom, Exponential, Linear, Polynomial, Power, Step, Table, Video
from tests.utility_specs.worths import by_red
from utility_specs.utilities import AnyUtilityTable

ANY = TypeAdapter(AnyUtilityTable)
RED = {"red": 0.5}


@pytest.mark.parametrize(
    ("table", "utility"),
    [
        ({"kind": "linear", "slope": 0.5}, Linear(1.0, 0.5)),
        ({"kind": "linear", "slope": 0.5, "u0": 2.0}, Linear(2.0, 0.5)),
        ({"kind": "exponential", "tau": "500 ms"}, Exponential(1.0, 0.5)),
        ({"kind": "exponential", "u0": 2.0, "tau": 3}, Exponential(2.0, 3.0)),
        ({"kind": "step", "lifetime": "1 min"}, Step(1.0, 60.0)),
        ({"kind": "step", "u0": 2.0, "lifetime": 0.5}, Step(2.0, 0.5)),
        ({"kind": "polynomial", "a1": "2 s"}, Polynomial(1.0, 2.0, 2.0)),
        ({"kind": "polynomial", "u0": 2.0, "a1": 2.0, "k": 3}, Polynomial(2.0, 2.0, 3.0)),
        ({"kind": "video"}, Video(1 / 30, 10.0)),
        ({"kind": "video", "a0": "100 ms", "a1": "5 s"}, Video(0.1, 5.0)),
        ({"kind": "power", "beta": 0.3}, Power(0.3)),
        (
            {"kind": "table", "points": [[0, 1], ["500 ms", 0.5], ["2 s", 0]]},
            Table(((0.0, 1.0), (0.5, 0.5), (2.0, 0.0))),
        ),
        ({"kind": "python", "function": f"{by_red.__module__}:by_red"}, Custom(by_red, RED, 60.0)),
        ({"kind": "python", "function": f"{by_red.__module__}:by_red", "until": "5 s"}, Custom(by_red, RED, 5.0)),
    ],
)
def test_a_table_stands_for_a_function_of_the_planner(table, utility):
    """Ages may be written with units; what is not written has its default; only `python` looks at features."""
    assert ANY.validate_python(table).utility(RED) == utility


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "linear", "slope": 1.0, "u0": float("nan")},
        {"kind": "exponential", "tau": float("inf")},
        {"kind": "power", "beta": float("nan")},
        {"kind": "table", "points": [[0, float("nan")]]},
        {"kind": "table", "points": [[float("inf"), 1.0]]},
        {"kind": "python", "function": 3},
    ],
)
def test_numbers_that_are_not_finite_are_refused(table):
    """Nothing without a meaning reaches the planner."""
    with pytest.raises(ValidationError):
        ANY.validate_python(table)
