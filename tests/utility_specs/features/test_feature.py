"""What all features have in common."""

import pytest
from pydantic import TypeAdapter, ValidationError

from utility_specs.features import AnyFeatureTable, ColorFraction, Size

ANY = TypeAdapter(AnyFeatureTable)


def test_each_kind_makes_its_feature():
    """The kind in the table decides, the default is taken over."""
    assert ANY.validate_python({"kind": "size", "default": 2.0}).feature() == Size(2.0)
    red = ANY.validate_python({"kind": "color_fraction", "color": "red"})
    assert red.feature() == ColorFraction("red", 0.0)


@pytest.mark.parametrize("table", [{}, {"kind": "sise"}, {"kind": "size", "default": float("inf")}])
def test_a_table_without_meaning_is_refused(table):
    """No kind, an unknown one, an infinite default."""
    with pytest.raises(ValidationError):
        ANY.validate_python(table)
