"""Without SciPy the oracle says what to install."""

import sys

import pytest

from studies.oracle import OracleUnavailable, optimum, upper_bound
from tests.studies.oracle.problems import one_stream


@pytest.mark.parametrize("question", [upper_bound, optimum])
def test_missing_scipy_is_named(monkeypatch, question):
    """Both questions raise OracleUnavailable, so that a report can leave the figure out."""
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    with pytest.raises(OracleUnavailable, match="study"):
        question(one_stream([0.0, 1.0], window=0.5, limit=1.0))
