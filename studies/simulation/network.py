"""What carries messages between robots: a medium of our own, or another simulator beside the agenda."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Protocol

from studies.simulation.agenda import Action, Agenda
from studies.simulation.medium import Medium

Arrive = Callable[[str, float], None]
"""Called with who receives a message, and when [s]: once, twice, or not at all."""


class Network(Protocol):
    """Carries messages of `size` bytes; times are true times [s]."""

    def send(
        self, t: float, size: int, sender: str, receivers: Iterable[str], arrive: Arrive, *, broadcast: bool
    ) -> None:
        """Send a message at `t`: once to all, or a copy to each."""

    def reliable(self, t: float, size: int, sender: str, receiver: str, arrive: Action) -> None:
        """Send a message at `t` until it arrives; it does so once."""

    def delay(self, sender: str, receiver: str) -> float:
        """How long small messages usually take [s]."""


class OverMedium:
    """Our own: when a message arrives is known when it is sent."""

    def __init__(self, medium: Medium, agenda: Agenda) -> None:
        self._medium = medium
        self._agenda = agenda

    def send(
        self, t: float, size: int, sender: str, receivers: Iterable[str], arrive: Arrive, *, broadcast: bool
    ) -> None:
        """Send a message at `t`: once to all, or a copy to each."""
        fly = self._medium.broadcast if broadcast else self._medium.unicast
        for receiver, arrivals in fly(t, size, sender, receivers).items():
            for arrival in arrivals:
                self._agenda.at(arrival, partial(arrive, receiver))

    def reliable(self, t: float, size: int, sender: str, receiver: str, arrive: Action) -> None:  # noqa: ARG002 -- a size takes no time here
        """Send a message at `t` until it arrives; what it takes of the rate is not counted."""
        self._agenda.at(self._medium.reliable(t, sender, receiver), arrive)

    def delay(self, sender: str, receiver: str) -> float:
        """How long a message takes that waits for no other [s]."""
        return self._medium.way(sender, receiver).delay
