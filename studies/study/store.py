"""Results on disk, a line of JSON for each task, so that a run that was interrupted goes on where it was."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TextIO

from studies.study.tasks import VERSION, Task

Record = dict[str, Any]
"""What a flight reached, see `flying.fly_one`."""


@dataclass(slots=True)
class Store:
    """Holds records by task; used in a `with` statement it takes in new ones, and writes each at once."""

    path: Path
    _records: dict[str, tuple[Task, Record]] = field(default_factory=dict, init=False)
    _file: TextIO | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        for task, record in _read(self.path):
            self._records[task.key] = task, record

    def __enter__(self) -> Self:
        """Open the file for what is to come."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        torn = self.path.exists() and not self.path.read_bytes().endswith(b"\n") and self.path.stat().st_size > 0
        self._file = self.path.open("a", encoding="utf-8")
        if torn:
            self._file.write("\n")
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __len__(self) -> int:
        return len(self._records)

    def __contains__(self, task: Task) -> bool:
        return task.key in self._records

    def __getitem__(self, task: Task) -> Record:
        return self._records[task.key][1]

    def get(self, task: Task) -> Record | None:
        """Return the record of a task, if there is one."""
        found = self._records.get(task.key)
        return None if found is None else found[1]

    def add(self, task: Task, record: Record) -> None:
        """Keep a record. Raises ValueError where the store is not open."""
        if self._file is None:
            raise ValueError("the store is not open")
        line = {"version": VERSION, "task": task.as_dict(), "record": record}
        self._file.write(json.dumps(line, allow_nan=False) + "\n")
        self._file.flush()
        self._records[task.key] = task, record

    def missing(self, tasks: Iterable[Task]) -> list[Task]:
        """Return the tasks, each once, of which there is no record."""
        wanted = {task.key: task for task in tasks}
        return [task for key, task in wanted.items() if key not in self._records]

    def of(self, tasks: Iterable[Task]) -> dict[Task, Record]:
        """Return the records there are of some tasks."""
        return {task: self[task] for task in tasks if task in self}


def _read(path: Path) -> Iterator[tuple[Task, Record]]:
    """Yield what a file holds of this version; a line that was cut off when somebody pulled the plug is left out."""
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            continue
        if entry["version"] == VERSION:
            yield Task.from_dict(entry["task"]), entry["record"]
