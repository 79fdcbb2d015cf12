"""What was found out about one thing."""

import errno
import os
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from proxy import exit_codes
from proxy.printable import clean

_BARRED = f"cannot be read: {os.strerror(errno.EACCES)}"
"""How messages end about what another user could read."""


class State(StrEnum):
    """How it is."""

    FINE = "fine"
    FINDING = "finding"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Finding:
    """One line: what was looked at, how it is, and in words what is and what to do."""

    check: str
    state: State
    text: str

    def __str__(self) -> str:
        return f"{self.state.value:<8} {self.check:<13} {clean(' '.join(self.text.split()))}"


def fine(check: str, text: str) -> Finding:
    """Return that there is nothing to do."""
    return Finding(check, State.FINE, text)


def finding(check: str, text: str) -> Finding:
    """Return that there is something to do."""
    return Finding(check, State.FINDING, text)


def unknown(check: str, text: str) -> Finding:
    """Return that it could not be looked at."""
    return Finding(check, State.UNKNOWN, text)


def mistake(check: str, problem: object) -> Finding:
    """Return that a file has to be corrected, or could not be looked at by this user."""
    text = str(problem)
    return (
        unknown(check, f"{text}: run it with sudo") if text.endswith(_BARRED) else finding(check, f"{text}: correct it")
    )


def exit_code(found: Iterable[Finding]) -> int:
    """Return 1 if there is anything to do, else 2 if something could not be looked at, else 0."""
    states = {each.state for each in found}
    if State.FINDING in states:
        return exit_codes.FAILED
    return exit_codes.NOT_SEEN if State.UNKNOWN in states else exit_codes.OK
