"""ns-3's Wi-Fi as the network of a simulated team: both go on in turn, whoever has the next event."""

from collections.abc import Iterable, Sequence
from random import Random
from typing import NamedTuple

from studies.ns3.radio import ALL, Radio
from studies.simulation.agenda import Action, Agenda
from studies.simulation.medium import MOST_TRIES, RELIABLE, RETRY
from studies.simulation.network import Arrive

JITTER = 0.001
"""Who sends does so within this time [s]: robots that hear the same would answer in the same instant, and collide."""
FORGOTTEN = 10.0
"""What has not arrived after so long never will [s]."""
USUAL = 0.004
"""How long a small message usually takes [s]."""


class _Flying(NamedTuple):
    since: float
    receivers: frozenset[str]
    arrive: Arrive


class _Channel:
    """What one robot sends another reliably: each message once, in order."""

    def __init__(self) -> None:
        self.sent = 0
        self._next = 0
        self._early: dict[int, Action] = {}

    def lacks(self, number: int) -> bool:
        """Whether a message has not arrived yet."""
        return number >= self._next and number not in self._early

    def take(self, number: int, at: float, arrive: Action) -> None:
        """A message arrived; it waits for those before it."""
        if self.lacks(number):
            self._early[number] = arrive
        while (ready := self._early.pop(self._next, None)) is not None:
            self._next += 1
            ready(at)


class Ns3Network:
    """Carries messages by a `radio` with so many robots on it. Unicast is UDP, too: Wi-Fi itself repeats it."""

    def __init__(self, radio: Radio, agenda: Agenda, robots: Sequence[str], seed: int = 0) -> None:
        self._radio = radio
        self._agenda = agenda
        self._robots = tuple(robots)
        self._numbers = {robot: number for number, robot in enumerate(robots)}
        self._random = Random(seed)
        self._flying: dict[int, _Flying] = {}
        self._sent = 0
        self._last: dict[str, float] = {}
        self._channels: dict[tuple[str, str], _Channel] = {}
        agenda.beside(self._go_on)

    def send(
        self, t: float, size: int, sender: str, receivers: Iterable[str], arrive: Arrive, *, broadcast: bool
    ) -> None:
        """Send a message at `t` [s] or a little later: once to all, or a copy to each."""
        wanted = frozenset(receivers)
        if broadcast:
            self._put(t, size, sender, ALL, _Flying(t, wanted, arrive))
            return
        for receiver in sorted(wanted):
            self._put(t, size, sender, self._numbers[receiver], _Flying(t, wanted, arrive))

    def reliable(self, t: float, size: int, sender: str, receiver: str, arrive: Action) -> None:
        """Send a message again and again until it arrives, as TCP does: after all that was sent so before it.

        What daemons do for that takes its time first.
        """
        channel = self._channels.setdefault((sender, receiver), _Channel())
        number = channel.sent
        channel.sent += 1

        def came(_: str, at: float) -> None:
            channel.take(number, at, arrive)

        def again(at: float, tries: int = MOST_TRIES) -> None:
            if tries and channel.lacks(number):
                self.send(at, size, sender, (receiver,), came, broadcast=False)
                self._agenda.at(at + RETRY, lambda later: again(later, tries - 1))

        self._agenda.at(t + RELIABLE, again)

    def delay(self, sender: str, receiver: str) -> float:  # noqa: ARG002 -- all are as far from each other
        """How long small messages usually take [s]."""
        return USUAL

    def _put(self, t: float, size: int, sender: str, receiver: int, flying: _Flying) -> None:
        self._sent += 1
        self._flying[self._sent] = flying
        # A robot's messages leave it in order: one that overtakes what it tells of would mislead.
        at = self._last[sender] = max(t + self._random.uniform(0.0, JITTER), self._last.get(sender, 0.0))
        self._radio.send(at, self._numbers[sender], receiver, size, self._sent)

    def _go_on(self, until: float) -> bool:
        """Let the radio go on until something arrives; whether that was before `until` [s]."""
        happened = False
        for arrival in self._radio.run(until):
            happened = True
            flying = self._flying.get(arrival.id)
            receiver = self._robots[arrival.receiver]
            if flying is not None and receiver in flying.receivers:
                flying.arrive(receiver, arrival.at)
        self._forget(until)
        return happened

    def _forget(self, now: float) -> None:
        """Forget messages that are over, the oldest first."""
        while self._flying:
            oldest = next(iter(self._flying))
            if self._flying[oldest].since > now - FORGOTTEN:
                return
            del self._flying[oldest]
