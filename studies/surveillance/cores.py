"""A part of a core: processes that may take no more, by a control group of the kernel. Needs root."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

ROOT = Path("/sys/fs/cgroup")
PERIOD = 10_000
"""Of the kernel's accounts: short, for a small computer is slow all the time and not stopped now and then [µs]."""


class CoresError(Exception):
    """Processes cannot be held to a part of a core here."""


@contextmanager
def held_to(part: float, processes: Sequence[int]) -> Iterator[None]:
    """Hold each of the processes to `part` of a core while in the block. Raises CoresError."""
    groups: list[Path] = []
    try:
        for pid in processes:
            groups.append(_group(f"sendworthy-{os.getpid()}-{pid}"))
            _limit(groups[-1], part)
            (groups[-1] / "cgroup.procs").write_text(str(pid))
        yield
    except OSError as error:
        raise CoresError(f"control groups: {error}") from None
    finally:
        for group in groups:
            _dissolve(group)


def _group(name: str) -> Path:
    """Make a group, of whichever version of control groups is there."""
    unified = (ROOT / "cgroup.controllers").exists()
    group = ROOT / name if unified else ROOT / "cpu" / _ours() / name
    group.mkdir()
    return group


def _ours() -> str:
    """Return the group that we are in, of the first version's."""
    lines = [line.split(":") for line in Path("/proc/self/cgroup").read_text().splitlines()]
    return next((path.strip("/") for _, controllers, path in lines if "cpu" in controllers.split(",")), "")


def _limit(group: Path, part: float) -> None:
    quota = round(part * PERIOD)
    if (group / "cpu.max").exists():
        (group / "cpu.max").write_text(f"{quota} {PERIOD}")
        return
    (group / "cpu.cfs_period_us").write_text(str(PERIOD))
    (group / "cpu.cfs_quota_us").write_text(str(quota))


def _dissolve(group: Path) -> None:
    """Give its processes back and remove it."""
    for pid in (group / "cgroup.procs").read_text().split():
        (group.parent / "cgroup.procs").write_text(pid)
    group.rmdir()
