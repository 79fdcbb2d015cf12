"""Aggregations as specs name them."""

import pytest
from pydantic import TypeAdapter

from planner import Aggregation, AggregationModel, Linear
from planner.errors import ProblemError
from tests.utility_specs.models import Greatest
from utility_specs.aggregations import AnyAggregation, PythonAggregation, aggregation_of

ANY = TypeAdapter(AnyAggregation)
MODELS = Greatest.__module__


@pytest.mark.parametrize("kind", list(Aggregation))
def test_every_aggregation_of_the_planner_has_a_name(kind):
    """None is left out, none is called otherwise."""
    assert aggregation_of(ANY.validate_python(str(kind)), Linear(1.0, 1.0)) is kind


def test_a_class_is_instantiated_once_and_tried():
    """However often it is asked for: the table keeps it."""
    table, before = ANY.validate_python({"python": f"{MODELS}:Greatest"}), Greatest.made
    model = aggregation_of(table, Linear(1.0, 1.0))
    assert isinstance(model, AggregationModel)
    assert isinstance(model, Greatest)
    assert aggregation_of(table, Linear(2.0, 1.0)) is model
    assert Greatest.made == before + 1


def test_a_table_that_was_read_is_read_again():
    """As pydantic does with what is valid already."""
    table = PythonAggregation(python=f"{MODELS}:Greatest")
    assert ANY.validate_python(table) == table


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("Failing", "^Failing.add.. failed: RuntimeError: one\ntwo$"),
        ("Endless", r"^Endless.value\(\) returned inf: it must be finite"),
        ("Listing", r"^Listing.empty\(\) returned a list: states must be hashable"),
        ("Demanding", r"models:Demanding\(\) failed: TypeError: "),
        ("Leaving", r"models:Leaving\(\) failed: SystemExit: no$"),
        ("Cancelled", r"models:Cancelled\(\) failed: CancelledError: late$"),
        ("Lacking", r"models:Lacking has no add\(\) and no value\(\); an aggregation has empty, add, value$"),
    ],
)
def test_a_class_that_cannot_be_used_is_named_with_what_is_wrong(name, says):
    """Before a flight, not in it."""
    with pytest.raises(ProblemError, match=says):
        aggregation_of(ANY.validate_python({"python": f"{MODELS}:{name}"}), Linear(1.0, 1.0))
