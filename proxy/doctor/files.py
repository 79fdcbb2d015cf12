"""Whether the specs are right, and the disk has room for the recordings."""

import shutil
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

from proxy.config import RecordConfig
from proxy.doctor.finding import Finding, finding, fine, mistake, unknown
from utility_specs.check import Report
from utility_specs.loader import holds_specs


def specs(path: Path) -> Iterator[Finding]:
    """Check the specs as `sendworthy check` does."""
    if not holds_specs(path):
        yield fine("specs", f"none in {path}: everything passes")
        return
    report = Report.on([path])
    yield from (mistake("specs", error) for error in report.errors)
    if not report.errors:
        types = sum(len(file.types) for file in report.files)
        warned = f", warnings: {len(report.warnings)} (sendworthy check {path})" * bool(report.warnings)
        yield fine("specs", f"{types} information type{'s' * (types != 1)} in {path}{warned}")


def recordings(record: RecordConfig, robot: str) -> Iterator[Finding]:
    """Look whether what the recordings of `robot` may take still fits, besides what they take already."""
    place = _existing(record.folder)
    free = shutil.disk_usage(place).free
    try:
        taken = sum(_size(file) for file in record.folder.iterdir() if fnmatch(file.name, f"{robot}-*.mcap"))
    except FileNotFoundError:
        taken = 0
    except PermissionError as error:
        yield unknown("recordings", f"{record.folder}: {error.strerror}: run it with sudo")
        return
    except OSError as error:
        yield finding("recordings", f"{record.folder}: {error.strerror}: correct record.folder")
        return
    wanted = record.disk_bytes - taken
    amounts = f"may grow by {_mb(wanted)}, and {_mb(free)} are free at {place}"
    if not record.on:
        yield fine("recordings", f"off ({_mb(free)} are free at {place})")
    elif wanted > free:
        yield finding("recordings", f"they {amounts}: make room, or lower record.disk_bytes")
    else:
        yield fine("recordings", f"they {amounts}")


def _existing(folder: Path) -> Path:
    """Return a folder, or the nearest one above it that is there."""
    place = folder.absolute()
    return next(each for each in (place, *place.parents) if _seen(each) or each == each.parent)


def _seen(folder: Path) -> bool:
    try:
        return folder.is_dir()
    except OSError:  # within a folder that this user may not look into
        return False


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:  # the daemon has just removed it
        return 0


def _mb(size: int) -> str:
    return f"{max(size, 0) / 1e6:.0f} MB"
