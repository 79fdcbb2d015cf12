"""What counts against the limits: our own sends, and what we know others to have sent."""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence

from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, Send, use_of
from proxy.core.view.traffic import Amount


class OwnSends:
    """Our sends, oldest first, by what they use of each limit in force."""

    def __init__(self) -> None:
        self._sent: deque[Send] = deque()
        self._leaving: dict[int, Send] = {}
        """Of these, large samples that the mesh has not taken yet."""
        self.leave_after = 0.0
        """How long after their decision large samples leave, at most, as far as the last ones say [s]."""

    def __iter__(self) -> Iterator[Send]:
        """Oldest first."""
        return iter(self._sent)

    def renumber(self, places: Sequence[int | None]) -> None:
        """New limits are in force, which were at these places before; nothing was used of those that are new."""
        self._sent = deque((t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in self._sent)
        self._leaving.clear()

    def note(self, now: float, use: tuple[float, ...], large: int | None) -> None:
        """A message is sent now, a `large` sample or something else."""
        send = now, use
        self._sent.append(send)
        if large is not None:
            self._leaving[large] = send

    def forget(self, before: float) -> None:
        """Of what was sent before this nothing counts any more."""
        while self._sent and self._sent[0][0] < before:
            self._sent.popleft()

    def used(self, since: float, k: int) -> float:
        """Return what they used of a limit."""
        return sum(use[k] for t, use in self._sent if t >= since)

    def handed(self, now: float, sample: int) -> None:
        """The mesh took a sample: a large one counts for a window from now on, not from when it was decided.

        Where the next one was sent a window after the decision, one window in four of ten flights of a robot alone
        held 1.23 to 1.31 limits, as this one had taken some ms longer to leave.
        """
        send = self._leaving.pop(sample, None)
        if send is not None and send in self._sent:
            self._sent.remove(send)
            self._sent.append((now, send[1]))
            took, weight = now - send[0], TUNING.departure_weight
            self.leave_after = min(
                max(took, (1.0 - weight) * self.leave_after + weight * took), TUNING.longest_departure
            )

    def refused(self, sample: int) -> None:
        """The mesh did not take a sample."""
        self._leaving.pop(sample, None)


def uses_of(
    now: float, sent: Iterable[tuple[float, Amount]], limits: tuple[Limit, ...], leave_after: float
) -> tuple[Send, ...]:
    """Return what this used of each limit that others sent.

    They announce when they decided, and their samples take as long to leave as ours: where who waited for their room
    sent a window after the decision, windows of eight busy daemons held up to 1.3 limits.
    """
    alike = {amount: use_of(*amount, limits, own=False) for amount in {amount for _, amount in sent}}
    return tuple([(min(t + leave_after, max(t, now)), alike[amount]) for t, amount in sent])
