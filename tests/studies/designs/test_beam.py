"""Beam search."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.tables import tabulate
from studies.designs.beam import Beam, WideningBeam
from studies.designs.design import worth
from tests.planner.windows import objectives, optimum, window


def reached(beam: Beam) -> float:
    beam.run(100_000)
    assert beam.done
    return beam.tables.gains.aim_facts + worth(beam.tables, beam.sends())


@pytest.mark.full
@given(st.integers(0, 10_000), st.booleans(), st.booleans())
def test_a_beam_of_any_width_finds_the_optimum(seed, by_bound, grid):
    """When no node is left out but tantamount ones of less value, the best plan remains."""
    problem = window(seed, horizon=5, constraints=1 + seed % 2, grid=grid)
    beam = Beam(tabulate(problem, beyond=True), 1_000, by_bound=by_bound)
    assert reached(beam) == pytest.approx(optimum(problem, objectives)[0])
    assert beam.proven


@pytest.mark.full
@given(st.integers(0, 10_000), st.booleans())
def test_a_widening_beam_ends_with_the_best_plan(seed, grid):
    """However narrow it begins, it goes on until nothing was left out."""
    problem = window(seed, horizon=6, constraints=1 + seed % 2, grid=grid)
    beam = WideningBeam(tabulate(problem, beyond=True), width=1, factor=2, rounds=3)
    assert reached(beam) == pytest.approx(optimum(problem, objectives)[0])
    assert beam.proven


def test_a_widening_beam_can_be_stopped_at_any_time():
    """It has a plan after the first iteration, and never a worse one later."""
    problem = window(2, robots=6, horizon=24)
    beam, values = WideningBeam(tabulate(problem, beyond=True), width=1, factor=2, rounds=3), []
    while beam.run(5):
        values.append(worth(beam.tables, beam.sends()))
    assert len(values) > 2
    assert values == sorted(values)


def test_a_narrow_beam_by_value_is_short_sighted():
    """It sends what fits and loses what comes later, where a bound says better."""
    narrow = dict.fromkeys((False, True), 0)
    for seed in range(25):
        problem = window(seed, horizon=6)
        best = optimum(problem, objectives)[0]
        for by_bound in narrow:
            beam = Beam(tabulate(problem, beyond=True), 1, by_bound=by_bound)
            narrow[by_bound] += reached(beam) < best - 1e-9 * abs(best)
    assert narrow[True] < narrow[False]


def test_an_iteration_extends_one_node():
    """A beam of one node by value takes an iteration a level and completes one plan."""
    beam = Beam(tabulate(window(1), beyond=True), 1, by_bound=False)
    beam.run(100_000)
    assert (beam.iterations, beam.plans) == (beam.tables.levels, 1)
