"""The columns that only `top` has."""

import pytest

from proxy.top.tables import FLEET, LIVE, per_second, why


def test_rates_have_a_digit_behind_the_point():
    """A dash is not known."""
    assert (per_second({"made": 9.96}, "made"), per_second({}, "made")) == ("10.0", "-")


@pytest.mark.parametrize(
    ("reasons", "text"),
    [
        ({}, "-"),
        ({"dropped:planner": 4.0}, "planner 4"),
        ({"dropped:constraint": 12.3, "dropped:planner": 0.5, "dropped:once": 0.1}, "constraint 12, planner 0.5, …"),
    ],
)
def test_the_most_frequent_reasons_are_named(reasons, text):
    """Two of them."""
    assert why({"why": reasons}) == text


@pytest.mark.parametrize("table", [LIVE, FLEET])
def test_columns_have_names_of_their_own(table):
    """And each says what it means."""
    assert len({column.head for column in table.columns}) == len(table.columns)
    assert all(column.means for column in table.columns)
