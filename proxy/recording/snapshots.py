"""Snapshots of the core: taken between two events, and put together again where a recording is replayed."""

import platform

from proxy.core.core import Core
from proxy.recording.entries import Snapshot
from proxy.recording.errors import RecordingError
from proxy.recording.pickling import pickled
from proxy.recording.spec_parts import SpecParts
from proxy.recording.tuning import TUNING
from proxy.recording.unpickling import unpickled
from proxy.version import version
from utility_specs import Specs


def taken(core: Core, number: int, now: float) -> Snapshot:
    """Return what a core knows before event `number`, at `now` on its clock [s]. On the loop's thread.

    Raises RecordingError where a part of it cannot be written, or it is too large.
    """
    data = pickled(core)
    if len(data) > TUNING.snapshot:
        raise RecordingError(f"{len(data):,} bytes are too many")
    return Snapshot(number, now, core.view.specs.generation, core.settings.version, platform.python_version(), data)


def check(snapshot: Snapshot) -> None:
    """Raise RecordingError where a snapshot is of a version that may decide otherwise, or name its fields otherwise."""
    here, python = version(), platform.python_version()
    if snapshot.version != here or _minor(snapshot.python) != _minor(python):
        raise RecordingError(
            f"its snapshot of the core is one of Sendworthy {snapshot.version} on Python {snapshot.python}, and here is"
            f" {here} on {python}: an exact replay takes that version; `--policy planner` flies its traffic anew"
        )


def restored(snapshot: Snapshot, specs: Specs) -> Core:
    """Return the core that a snapshot is of, under its specs. Raises RecordingError for what is no snapshot."""
    if len(snapshot.data) > TUNING.snapshot:
        raise RecordingError(f"its snapshot of the core claims to have {len(snapshot.data):,} bytes")
    core = unpickled(snapshot.data, SpecParts(specs))
    if type(core) is not Core:
        raise RecordingError("its snapshot is none of a core")
    return core


def _minor(python: str) -> list[str]:
    return python.split(".")[:2]
