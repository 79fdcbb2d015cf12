"""The channel of the benchmark: it carries what the limits allow, and refuses the rest.

A message that does not fit into its window (Eq. 5, of all robots on one clock) is lost to everybody, and the window
does not count it. Its sender is not told. What robots tell each other besides samples uses bytes of a throughput limit
as samples do, and none of a limit of messages.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

from planner.constraints import CLOSED, SLACK
from planner.measures import Measure, Messages
from studies.simulation.agenda import Action
from studies.simulation.network import Arrive, Network


class Channel:
    """A network over which no more arrives than the limits allow."""

    def __init__(self, carrier: Network, limits: Sequence[Measure]) -> None:
        self._carrier = carrier
        self._limits = tuple(limits)
        self._carried: list[list[tuple[float, float]]] = [[] for _ in limits]
        """By limit when something was sent, and what it uses."""
        self._samples = True
        self.refused: list[float] = []
        """When samples were sent that were refused [s]."""

    @contextmanager
    def telling(self) -> Iterator[None]:
        """What is sent meanwhile is no sample."""
        self._samples = False
        try:
            yield
        finally:
            self._samples = True

    def send(
        self, t: float, size: int, sender: str, receivers: Iterable[str], arrive: Arrive, *, broadcast: bool
    ) -> None:
        """Send a message at `t`, if it fits."""
        uses = [self._use(limit, size) for limit in self._limits]
        if not all(self._fits(k, t, use) for k, use in enumerate(uses)):
            if self._samples:
                self.refused.append(t)
            return
        self._count(t, uses)
        self._carrier.send(t, size, sender, receivers, arrive, broadcast=broadcast)

    def reliable(self, t: float, size: int, sender: str, receiver: str, arrive: Action) -> None:
        """Send a message at `t` until it arrives: it is counted, and never refused."""
        with self.telling():
            self._count(t, [self._use(limit, size) for limit in self._limits])
        self._carrier.reliable(t, size, sender, receiver, arrive)

    def delay(self, sender: str, receiver: str) -> float:
        """How long a message takes [s]."""
        return self._carrier.delay(sender, receiver)

    def _use(self, limit: Measure, size: int) -> float:
        return limit.use(size, 1, own=True) if self._samples or not isinstance(limit, Messages) else 0.0

    def _fits(self, k: int, t: float, use: float) -> bool:
        """Whether the window that ends with the message has room for it; one that is oversized has a longer window."""
        limit = self._limits[k]
        begin = t - limit.window * max(1.0, use / limit.limit) - CLOSED
        used = 0.0
        for at, each in reversed(self._carried[k]):
            if at < begin:
                break
            used += each
        return used + use <= max(use, limit.limit) * (1 + SLACK)

    def _count(self, t: float, uses: Sequence[float]) -> None:
        for carried, use in zip(self._carried, uses, strict=True):
            if use > 0.0:
                carried.append((t, use))
