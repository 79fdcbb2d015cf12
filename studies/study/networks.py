"""The networks of the study, by name: ns-3's Wi-Fi or a medium of our own, and what else is on the channel."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from random import Random
from threading import Lock

from studies.ns3.network import JITTER, USUAL, Ns3Network
from studies.ns3.radio import AD_HOC, INFRASTRUCTURE, Radio
from studies.simulation.agenda import Action, Agenda
from studies.simulation.medium import Medium
from studies.simulation.network import Arrive, Network, OverMedium
from studies.study.tasks import Task

BROADCAST_RATE, UNICAST_RATE = 500_000.0, 1_250_000.0
"""Those of our own medium [B/s]: 2,048 B take 4.1 and 1.6 ms, as they do in ns-3 with everything that frames need."""
NEIGHBOUR = "neighbour"
"""Who sends what is no business of the team."""
PACKET = 1_000
"""Of the neighbour's [B]."""
CHANNELS = {"adhoc": AD_HOC, "infrastructure": INFRASTRUCTURE}

_ONE_RADIO = Lock()
"""ns-3 simulates one channel at a time in a process; a cluster's worker may have several threads."""

Carry = Callable[[Agenda], Network]


@contextmanager
def network(task: Task, robots: Sequence[str]) -> Iterator[Carry]:
    """Make the network of a task, for one flight. Raises Ns3Unavailable."""
    everybody = [*robots, NEIGHBOUR] if task.background else list(robots)
    if task.network == "own":
        medium = Medium(own_rate(task), 0.0, task.loss, jitter=JITTER / 2, seed=task.seed)
        yield partial(_beside, task, partial(OverMedium, medium))
        return
    channel = replace(CHANNELS[task.network], loss=task.loss)
    with _ONE_RADIO, Radio(len(everybody), channel, task.seed) as radio:
        yield partial(_beside, task, lambda agenda: Ns3Network(radio, agenda, everybody, task.seed))


def own_rate(task: Task) -> float:
    """Return the rate of our own medium for what a task sends [B/s]."""
    return UNICAST_RATE if task.unicast else BROADCAST_RATE


def usual_delay(task: Task) -> float:
    """Return how long a message of the study takes where it waits for no other [s]."""
    return task.latency + USUAL


def _beside(task: Task, carry: Carry, agenda: Agenda) -> Network:
    """Add latency and background traffic to a network."""
    carrier = carry(agenda)
    if task.background:
        _Neighbour(carrier, agenda, task).start()
    return Later(carrier, agenda, task.latency) if task.latency else carrier


class Later:
    """A network over which everything arrives later by `latency` [s]: what relays and slow computers add."""

    def __init__(self, carrier: Network, agenda: Agenda, latency: float) -> None:
        self._carrier, self._agenda, self._latency = carrier, agenda, latency

    def send(
        self, t: float, size: int, sender: str, receivers: Iterable[str], arrive: Arrive, *, broadcast: bool
    ) -> None:
        """Send a message at `t`."""

        def later(receiver: str, at: float) -> None:
            self._agenda.at(at + self._latency, partial(arrive, receiver))

        self._carrier.send(t, size, sender, receivers, later, broadcast=broadcast)

    def reliable(self, t: float, size: int, sender: str, receiver: str, arrive: Action) -> None:
        """Send a message at `t` until it arrives."""
        self._carrier.reliable(t, size, sender, receiver, lambda at: self._agenda.at(at + self._latency, arrive))

    def delay(self, sender: str, receiver: str) -> float:
        """How long small messages usually take [s]."""
        return self._carrier.delay(sender, receiver) + self._latency


class _Neighbour:
    """Sends packets at random intervals to nobody of the team."""

    def __init__(self, carrier: Network, agenda: Agenda, task: Task) -> None:
        self._carrier, self._agenda = carrier, agenda
        self._pace = task.background / PACKET
        self._random = Random(f"{task.seed} {NEIGHBOUR}")

    def start(self) -> None:
        """Begin at the start of the flight."""
        self._agenda.at(self._random.expovariate(self._pace), self._send)

    def _send(self, t: float) -> None:
        self._carrier.send(t, PACKET, NEIGHBOUR, (), _nobody, broadcast=True)
        self._agenda.at(t + self._random.expovariate(self._pace), self._send)


def _nobody(receiver: str, at: float) -> None:
    """Nobody of the team hears the neighbour."""
