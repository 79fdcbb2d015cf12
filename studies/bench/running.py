"""Flies many missions by many policies, in several processes, and shows how far it is."""

from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from pathlib import Path

from studies.bench.errors import BenchError
from studies.bench.flying import BUILT_IN, Score, check, fly
from studies.bench.folder import load
from studies.processes import processes
from studies.progress_bar import flights


def fly_all(missions: Sequence[Path], policies: Sequence[str], jobs: int) -> list[Score]:
    """Fly each mission by each policy; return scores by mission, then policy. Raises BenchError."""
    for name in policies:
        check(name)
    known = {load(path).head.name: path for path in missions}
    if len(known) < len(missions):
        raise BenchError("two of the missions have the same name")
    tasks = [(path, name) for path in known.values() for name in policies]
    order = {task: number for number, task in enumerate(tasks)}
    found: dict[int, Score] = {}
    with flights(len(tasks), float(len(tasks))) as advance:
        for task, score in _flown(tasks, jobs):
            found[order[task]] = score
            advance(1.0)
    return [found[number] for number in range(len(tasks))]


def _flown(tasks: Sequence[tuple[Path, str]], jobs: int) -> Iterator[tuple[tuple[Path, str], Score]]:
    """Fly here, or in other processes, those first that take longest."""
    if jobs == 1:
        for task in tasks:
            yield task, _fly(*task)
        return
    pool = processes(jobs)
    slow = list(BUILT_IN)[:2]
    try:
        futures = {pool.submit(_fly, *task): task for task in sorted(tasks, key=lambda task: task[1] not in slow)}
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _fly(path: Path, name: str) -> Score:
    return fly(load(path), name)
