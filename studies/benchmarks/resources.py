"""What processes of this machine take, as the kernel tells."""

import time
from pathlib import Path

_CPU_CLOCK = 2
"""The kind of clock in the lowest bits of its number: of a process, what the scheduler counts."""


def processor_time(pid: int) -> float:
    """Return what a process has taken of the processor up to now [s]."""
    return time.clock_gettime(~pid << 3 | _CPU_CLOCK)


def threads(pid: int) -> int:
    """Return how many threads a process has."""
    return int(_status(pid)["Threads"])


def resident_memory(pid: int) -> int:
    """Return what a process has of the memory [B]."""
    return _bytes(pid, "VmRSS")


def private_memory(pid: int) -> int:
    """Return what a process has of the memory and shares with nobody, no file either [B]; OSError where untold."""
    return _bytes(pid, "RssAnon")


def _bytes(pid: int, field: str) -> int:
    return 1024 * int(_status(pid)[field].split()[0])


def _status(pid: int) -> dict[str, str]:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return {name: value for name, _, value in (line.partition(":") for line in lines)}
