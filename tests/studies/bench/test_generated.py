"""Missions that are drawn."""

import pytest

from studies.bench.folder import MISSIONS, names
from studies.bench.format import text_of
from studies.bench.generated import GENERATED

BY_NAME = {drawn.name: drawn for drawn in GENERATED}


def test_all_of_them_are_there():
    """And one that was recorded."""
    assert set(names()) == {*BY_NAME, "recorded-cameras"}


@pytest.mark.parametrize(
    "name",
    ["paper-mixed", *(pytest.param(n, marks=pytest.mark.full) for n in BY_NAME if n != "paper-mixed")],
)
def test_a_mission_is_written_anew_byte_for_byte(name):
    """With its bound."""
    pytest.importorskip("scipy")
    assert text_of(BY_NAME[name].mission()) == (MISSIONS / f"{name}.jsonl").read_text()
