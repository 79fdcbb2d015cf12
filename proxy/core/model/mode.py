"""The modes of the daemon."""

from enum import StrEnum
from typing import Self


class Mode(StrEnum):
    """What the daemon does with its decisions."""

    PASS = "pass"  # noqa: S105 - not a password
    """A plain bridge: no decisions."""
    SHADOW = "shadow"
    """Decides, counts and explains, but forwards everything."""
    ENFORCE = "enforce"
    """Decides and acts on it."""

    @classmethod
    def read(cls, raw: bytes) -> Self:
        """Return the mode that somebody names; raises ValueError, which names those that there are."""
        try:
            return cls(raw.decode())
        except ValueError:
            raise ValueError(f"a mode is one of {', '.join(cls)}") from None


def in_force(daemon: Mode, said: str | None) -> Mode:
    """Return the mode of a type of which a spec says so: the daemon's own if nothing, and where that is `pass`."""
    return daemon if said is None or daemon is Mode.PASS else Mode(said)
