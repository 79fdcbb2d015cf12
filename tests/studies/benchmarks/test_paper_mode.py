"""The page of paper mode beside the paper."""

from studies.benchmarks.report import Figure, Table


def test_deviations_come_first_then_the_reductions(measured):
    """Four tables of the ones, a figure and four tables of the others."""
    kinds = [type(result) for result in measured("paper_mode")]
    assert kinds == [Table] * 4 + [Figure] + [Table] * 4
