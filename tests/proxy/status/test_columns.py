"""Tables that fit into a terminal."""

import pytest

from proxy.status.columns import Column, Table, aligned, fitted, shortened, width_of

TABLE = Table(
    "Things",
    "What there is.",
    "things",
    (
        Column("NAME", "its name", lambda row: row["name"], ("name",), name=True),
        Column("WHY", "its reason", lambda _: "because", (), rank=2, left=True),
        Column("MANY", "how many", lambda _: "7", (), rank=1),
        Column("AGE", "how old", lambda _: "12 ms", ()),
    ),
)
ROWS = [{"name": "robot/r1/sensors/front/camera"}, {"name": "a"}]


def test_without_a_width_nothing_is_left_out():
    """As for a file."""
    assert fitted(TABLE, ROWS).lines() == [
        "NAME                           WHY      MANY    AGE",
        "robot/r1/sensors/front/camera  because     7  12 ms",
        "a                              because     7  12 ms",
    ]


def test_names_are_shortened_before_a_column_is_left_out():
    """In their middle, for their ends tell most."""
    fits = fitted(TABLE, ROWS, 45)
    assert fits.left_out == ()
    assert fits.lines()[1] == "robot/r…rs/front/camera  because     7  12 ms"
    assert max(map(len, fits.lines())) == 45


def test_the_column_of_the_highest_rank_is_left_out_first():
    """And named; those of rank 0 stay."""
    assert fitted(TABLE, ROWS, 35).left_out == ("WHY",)
    assert fitted(TABLE, ROWS, 24).left_out == ("MANY", "WHY")
    assert fitted(TABLE, ROWS, 13).lines() == ["NAME      AGE", "r…mera  12 ms", "a       12 ms"]


@pytest.mark.parametrize("width", range(13, 60))
def test_a_table_is_as_wide_as_it_may_be_at_most(width):
    """At any width that has room for the least of it."""
    assert max(map(len, fitted(TABLE, ROWS, width).lines())) <= width


def test_what_has_no_room_at_all_is_as_narrow_as_it_can_be():
    """Nothing fails in a tiny terminal."""
    assert max(map(len, fitted(TABLE, ROWS, 3).lines())) == 13


def test_signs_that_are_two_places_wide_count_twice():
    """And those that stand on others not at all."""
    assert [width_of(text) for text in ("abc", "カメラ", "e\u0301")] == [3, 6, 1]
    assert aligned("カメラ", 8, left=True) == "カメラ  "
    assert aligned("é", 3, left=False) == "  é"
    assert width_of(shortened("robot/カメラ/正面", 10)) <= 10
