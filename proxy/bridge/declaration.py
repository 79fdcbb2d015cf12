"""What all declarations of Zenoh have in common."""

from typing import Protocol

import zenoh


class Declaration(Protocol):
    """A subscriber, queryable or token that can be taken back."""

    def undeclare(self) -> None:
        """Take it back."""


def matches(publisher: zenoh.Publisher) -> bool:
    """Whether anybody subscribes to what `publisher` publishes."""
    # The stubs promise a bool; the binding returns a MatchingStatus.
    status: object = publisher.matching_status
    return bool(getattr(status, "matching", status))
