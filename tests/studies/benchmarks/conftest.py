"""Each benchmark is measured once, for all tests that look at its tables."""

import fcntl
import pickle
from functools import cache

import pytest

from studies.benchmarks.__main__ import BENCHMARKS


def pytest_itemcollected(item):
    """What measures takes long."""
    if "measured" in item.fixturenames:
        item.add_marker(pytest.mark.full)


@pytest.fixture(scope="session")
def measured(tmp_path_factory, worker_id):
    """What a quick run of a benchmark returns, by its name; of all processes that run tests the first one measures."""
    benchmarks, base = dict(BENCHMARKS), tmp_path_factory.getbasetemp()
    folder = base if worker_id == "master" else base.parent

    @cache
    def result(name):
        with (folder / f"measured-{name}.pickle").open("a+b") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            if not file.tell():
                pickle.dump(benchmarks[name][1](True), file)
            file.seek(0)
            return pickle.load(file)  # noqa: S301 - of our own

    return result
