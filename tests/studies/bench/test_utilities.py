"""Utilities of mission files."""

import pytest

from planner import Exponential, Linear, Polynomial, Step, Video
from planner.utility import Custom, Power, Table
from studies.bench.utilities import spec_of, table_of, utility_of
from studies.simulation.missions import specs_of

ALL = (
    Linear(2.0, 0.5),
    Exponential(1.0, 3.0),
    Step(1.0, 2.0),
    Polynomial(1.0, 3.0, 2.0),
    Video(0.1, 5.0),
    Power(0.5),
    Table(((0.0, 1.0), (2.0, 0.0))),
)


@pytest.mark.parametrize("utility", ALL, ids=lambda utility: type(utility).__name__)
def test_a_utility_comes_back_from_its_table_and_from_a_spec(utility):
    """All kinds but functions in Python."""
    table = table_of(utility)
    assert utility_of(table) == utility
    type_of = f'[[information_type]]\nname = "t"\nkeys = ["k"]\naggregation = "sum"\nutility = {spec_of(table)}\n'
    (read,) = specs_of(f'[[constraint]]\nkind = "throughput"\nlimit = "1 kB/s"\n{type_of}').types
    assert read.utility_of({}) == utility


def test_what_no_file_has_is_told():
    """By the kind."""
    with pytest.raises(ValueError, match="no utility of the kind Custom"):
        table_of(Custom(lambda ages, _features: ages, {}))
