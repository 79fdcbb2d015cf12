"""Obeys what an operator orders all robots, where the configuration allows it."""

import logging
from collections.abc import Callable
from contextlib import nullcontext
from functools import partial

from proxy.bridge.fleet import Obey, Outcome
from proxy.config import FleetConfig
from proxy.core.model.mode import Mode
from proxy.errors import PushError
from proxy.pushed import Folder, unpack
from proxy.reloading import Reloading, unjudged
from utility_specs import SpecsError
from utility_specs.imports import nothing_imported

log = logging.getLogger(__name__)

FROM_ANYBODY = (
    "specs that whoever is on the mesh may push run no Python here: set fleet.token or access control, or copy them to "
    "the robot"
)


def orders(
    config: FleetConfig, robot: str, switch: Callable[[Mode], None], reloading: Reloading, *, guarded: bool
) -> dict[str, Obey]:
    """Return what obeys each order that is allowed; `guarded`: they come from operators alone."""
    obeyed: dict[str, Obey] = {}
    if config.mode:
        obeyed["mode"] = partial(switched, robot, switch)
    if config.specs:
        obeyed["specs"] = partial(replaced, robot, reloading, python=guarded)
    return obeyed


def switched(robot: str, switch: Callable[[Mode], None], raw: bytes) -> Outcome:
    """Switch to the mode that was ordered; `switch` returns when that is done."""
    try:
        mode = Mode.read(raw)
    except ValueError as error:
        return Outcome(robot, obeyed=False, said=(str(error),))
    try:
        switch(mode)
    except TimeoutError:
        return Outcome(robot, obeyed=False, said=("it is busy, and will do it later",))
    return Outcome(robot, obeyed=True, said=(f"mode {mode.value}",))


def replaced(robot: str, reloading: Reloading, raw: bytes, *, python: bool) -> Outcome:
    """Put the specs that were pushed in the place of ours and in force; what was there stays if anything is wrong.

    The `python` that they name runs with all that this daemon may do: only where that is wanted.
    """
    folder = Folder(reloading.loaded.config.specs.path)
    try:
        files = unpack(raw)
        with nullcontext() if python else nothing_imported(FROM_ANYBODY):
            folder.put(files)
    except (PushError, SpecsError) as error:
        return _refused(robot, tuple(str(error).splitlines()))
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever comes, a daemon goes on as before
        return _refused(robot, (unjudged(error),))
    problems = reloading.reload("specs were pushed")
    if problems:
        folder.undo()
        reloading.reload("the last specs are back")
        return _refused(robot, problems)
    specs = reloading.loaded.specs
    return Outcome(robot, obeyed=True, said=(f"specs {specs.generation} in force",))


def _refused(robot: str, problems: tuple[str, ...]) -> Outcome:
    log.warning("specs that were pushed are refused: %s", "; ".join(problems))
    return Outcome(robot, obeyed=False, said=problems)
