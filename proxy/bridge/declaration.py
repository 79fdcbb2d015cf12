"""What all declarations of Zenoh have in common."""

from typing import Protocol


class Declaration(Protocol):
    """A subscriber, queryable or token that can be taken back."""

    def undeclare(self) -> None:
        """Take it back."""
