"""The threads of this process: which there are, and what they are called."""

import re
import threading
from pathlib import Path

_TASKS = Path("/proc/self/task")
_ZENOH = re.compile(r"(app|acc|net|rx|tx)-\d+")
"""How Zenoh calls the threads of its runtimes: by what they do, and numbered."""


def others() -> list[int]:
    """Return the kernel's numbers of all threads but the one that asks."""
    own = threading.get_native_id()
    return [native for native in (int(task.name) for task in _TASKS.iterdir()) if native != own]


def names(natives: list[int]) -> dict[int, str]:
    """Return the names of threads that are there: what Python calls those it started, what the kernel calls others.

    A thread of Zenoh that asked Python in a callback which thread it is, as logging does, is a dummy there for good.
    """
    known = threading.enumerate()
    ours = {each.native_id: each.name for each in known if not isinstance(each, threading._DummyThread)}  # noqa: SLF001
    found = {}
    for native in natives:
        try:
            found[native] = ours.get(native) or (_TASKS / str(native) / "comm").read_text().strip()
        except OSError:
            continue
    return found


def is_zenohs(name: str) -> bool:
    """Whether a thread of this name is one of Zenoh's."""
    return bool(_ZENOH.fullmatch(name))
