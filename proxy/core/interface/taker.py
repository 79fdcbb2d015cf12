"""Who takes in events: a core, or whoever stands before one and notes what it does."""

from typing import Protocol

from proxy.core.interface.commands import Command
from proxy.core.interface.events import Event


class Taker(Protocol):
    """Takes in events, and says what is to be done."""

    def handle(self, event: Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""

    def pass_on(self, event: Event) -> list[Command] | None:
        """Do the same, if all that is to be done is to send a sample on or to note that it went; None: it is not."""
