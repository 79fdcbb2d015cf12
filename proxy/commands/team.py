"""What daemons that answer say of their team, as far as it matters to whoever listens to its samples."""

from collections.abc import Sequence
from typing import Any

from proxy.core.model.mode import Mode
from utility_specs import Specs

Status = dict[str, Any]
"""What `sendworthy status --json` shows of a robot."""


def robots_of(statuses: Sequence[Status]) -> list[str]:
    """Return the names of all robots that are known, each once."""
    known = [[status["robot"], *(peer["robot"] for peer in status.get("peers", ()))] for status in statuses]
    return sorted({str(robot) for each in known for robot in each})


def notes_on(statuses: Sequence[Status]) -> list[str]:
    """Say what makes what was heard less than what there is, and what is in force already."""
    notes = []
    deciding = sorted({robot for status in statuses for robot in _deciding(status)})
    if deciding:
        notes.append(
            f"In mode enforce, with specs: {', '.join(deciding)}. What they dropped was not heard, so there is more of"
            " it than is said here; `sendworthy mode shadow --fleet` shows everything."
        )
    for status in statuses:
        limits = [f"{limit['constraint']}: {_limit(limit)}" for limit in status.get("budget", ())]
        notes += [f"In force at {status['robot']} now: {'; '.join(limits)}."] if limits else []
    return notes


def _deciding(status: Status) -> list[str]:
    """Return who of a robot and its peers drops samples."""
    return [
        str(each["robot"])
        for each in (status, *status.get("peers", ()))
        if each.get("mode") == Mode.ENFORCE.value and each.get("specs") not in {None, "", Specs.empty().generation}
    ]


def _limit(limit: Status) -> str:
    """Word a limit, and what of an adaptive one is in force."""
    adaptive = limit.get("adaptive")
    part = f", of which {adaptive['in_force'] * 100:.3g} %, as the channel is" if adaptive else ""
    return f"{limit['limit']:.6g} {limit['unit']} in any {limit['window']:g} s{part}"
