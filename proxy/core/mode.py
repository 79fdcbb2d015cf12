"""The modes of the daemon."""

from enum import StrEnum


class Mode(StrEnum):
    """What the daemon does with its decisions."""

    PASS = "pass"  # noqa: S105 - not a password
    """A plain bridge: no decisions."""
    SHADOW = "shadow"
    """Decides, counts and explains, but forwards everything."""
    ENFORCE = "enforce"
    """Decides and acts on it."""
