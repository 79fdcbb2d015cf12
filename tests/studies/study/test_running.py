"""Tasks flown here and on a cluster."""

import os

import pytest

from proxy.extras import there
from studies.study.errors import StudyError
from studies.study.running import run
from studies.study.store import Store
from studies.study.tasks import Task

SMALL = Task("best", "mixed", 5.0, 0, network="own", robots=3, seconds=4.0, iterations=10)
TASKS = [SMALL.but(seed=seed) for seed in range(3)]
BY_CHANCE = ("decision", "cpu")
"""What a record has of the machine."""


def figures(store, task):
    return {name: value for name, value in store[task].items() if name not in BY_CHANCE}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """All tasks flown in this process."""
    store = Store(tmp_path_factory.mktemp("flown") / "records.jsonl")
    assert run(TASKS, store).flown == len(TASKS)
    return store


@pytest.mark.full
def test_what_was_flown_is_not_flown_again(flown):
    """A run goes on where another one ended."""
    assert run(TASKS, Store(flown.path)).flown == 0


@pytest.mark.full
def test_several_processes_reach_the_same(flown, tmp_path):
    """Task by task."""
    store = Store(tmp_path / "records.jsonl")
    assert run(TASKS, store, jobs=2).flown == len(TASKS)
    assert [figures(store, task) for task in TASKS] == [figures(flown, task) for task in TASKS]


def test_a_flight_that_fails_ends_no_study(tmp_path):
    """It is named, and missing the next time."""
    wrong = SMALL.but(contender="nobody")
    store = Store(tmp_path / "records.jsonl")
    outcome = run([wrong, SMALL], store)
    assert outcome.flown == 1
    ((task, why),) = outcome.failed
    assert task == wrong
    assert "nobody" in why
    assert Store(store.path).missing([wrong, SMALL]) == [wrong]


@pytest.mark.skipif(not there("distributed"), reason="needs the extra cluster")
@pytest.mark.full
def test_where_no_cluster_is_that_is_said(tmp_path):
    """With its address."""
    with pytest.raises(StudyError, match=r"tcp://127\.0\.0\.1:9: no Dask scheduler answers there"):
        run(TASKS, Store(tmp_path / "records.jsonl"), dask="tcp://127.0.0.1:9")


@pytest.mark.full
@pytest.mark.skipif(not there("distributed"), reason="needs the extra cluster")
@pytest.mark.filterwarnings("default")
def test_a_cluster_of_two_workers_reaches_the_same(flown, tmp_path, monkeypatch):
    """Over ns-3 as well, though a worker has several threads."""
    from distributed import LocalCluster  # noqa: PLC0415 - an extra

    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [os.getcwd(), os.environ.get("PYTHONPATH")])))  # noqa: PTH109
    both = [*TASKS, *(task.but(network="adhoc") for task in TASKS)]
    here = Store(tmp_path / "here.jsonl")
    run(both[3:], here)
    store = Store(tmp_path / "records.jsonl")
    with LocalCluster(n_workers=2, threads_per_worker=2, processes=True, dashboard_address=None) as cluster:
        assert run(both, store, dask=cluster.scheduler_address).flown == len(both)
    assert [figures(store, task) for task in both[:3]] == [figures(flown, task) for task in both[:3]]
    assert [figures(store, task) for task in both[3:]] == [figures(here, task) for task in both[3:]]
