"""Runs tasks: in processes of this machine, or on a Dask cluster. Each result is stored as soon as it is there."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from proxy.extras import needs, there
from studies.ns3.errors import Ns3Unavailable
from studies.oracle import OracleUnavailable
from studies.processes import processes
from studies.progress_bar import flights
from studies.study.costs import expected
from studies.study.errors import StudyError
from studies.study.flying import fly_one
from studies.study.store import Record, Store
from studies.study.tasks import Task

HOPELESS = (Ns3Unavailable, OracleUnavailable)
"""What is wrong with one flight then is wrong with all."""

Finished = Iterator[tuple[Task, Callable[[], Record]]]


@dataclass(slots=True)
class Outcome:
    """How many tasks were flown, and which failed, why."""

    flown: int = 0
    failed: list[tuple[Task, str]] = field(default_factory=list)


def run(tasks: Sequence[Task], store: Store, *, jobs: int = 1, dask: str = "") -> Outcome:
    """Fly all tasks whose records are missing. Raises StudyError where none can be flown."""
    missing = store.missing(tasks)
    outcome = Outcome()
    if not missing:
        return outcome
    finished = _on_cluster(missing, dask) if dask else _here(missing, jobs)
    with store, flights(len(missing), sum(map(expected, missing))) as advance:
        for task, result in finished:
            try:
                store.add(task, result())
                outcome.flown += 1
            except HOPELESS as error:
                finished.close()  # type: ignore[attr-defined] # both are generators
                raise StudyError(str(error)) from None
            except Exception as error:  # noqa: BLE001 - one flight that fails does not end the study
                outcome.failed.append((task, f"{type(error).__name__}: {error}"))
            advance(expected(task))
    return outcome


def _here(tasks: Sequence[Task], jobs: int) -> Finished:
    """Fly in this process, or in several others: ns-3 has one simulator in each."""
    if jobs == 1:
        for task in tasks:
            yield task, lambda task=task: fly_one(task)  # type: ignore[misc]
        return
    pool = processes(jobs)
    try:
        futures = {pool.submit(fly_one, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future.result
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_cluster(tasks: Sequence[Task], address: str) -> Finished:
    """Send the tasks to a Dask cluster whose workers have this package. Raises StudyError."""
    if not there("distributed"):
        raise StudyError(f"--dask {needs('cluster')}")
    distributed: Any = import_module("distributed")
    try:
        client = distributed.Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise StudyError(f"{address}: no Dask scheduler answers there: {error}") from None
    with client:
        if not client.scheduler_info()["workers"]:
            raise StudyError(f"{address}: the cluster has no workers; start some with `dask worker {address}`")
        futures = client.map(fly_one, tasks, pure=False)
        of = {future.key: task for future, task in zip(futures, tasks, strict=True)}
        for future in distributed.as_completed(futures, loop=client.loop):
            yield of[future.key], future.result
