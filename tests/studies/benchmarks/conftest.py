"""Each benchmark is measured once, for all tests that look at its tables."""

from functools import cache

import pytest

from studies.benchmarks.__main__ import BENCHMARKS


def pytest_itemcollected(item):
    """What measures takes long."""
    if "measured" in item.fixturenames:
        item.add_marker(pytest.mark.full)


@pytest.fixture(scope="session")
def measured():
    """What a quick run of a benchmark returns, by its name."""
    benchmarks = dict(BENCHMARKS)
    return cache(lambda name: benchmarks[name][1](True))
