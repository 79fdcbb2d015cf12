"""What all declarations of Zenoh have in common."""

from typing import Protocol

import zenoh


class Declaration(Protocol):
    """A subscriber, queryable or token that can be taken back."""

    def undeclare(self) -> None:
        """Take it back."""


def matches(one: zenoh.Publisher | zenoh.Querier) -> bool:
    """Whether anybody subscribes to what a publisher publishes, or answers what a querier asks."""
    # The stubs promise a bool; the binding returns a MatchingStatus.
    status: object = one.matching_status
    return bool(getattr(status, "matching", status))
