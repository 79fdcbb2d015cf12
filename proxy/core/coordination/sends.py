"""What counts against the limits: our own sends, and what we know others to have sent."""

from collections.abc import Collection, Sequence
from itertools import islice

from proxy.core.coordination.tuning import TUNING
from proxy.core.market.room import SendLog
from proxy.core.model.limits import Limit, Send, longest_window, use_of
from proxy.core.view.peer import Entry
from proxy.core.view.traffic import TrafficLog


class OwnSends(SendLog):
    """Our sends, by what they use of each limit in force."""

    def __init__(self) -> None:
        super().__init__()
        self._leaving: dict[int, Send] = {}
        """Of these, large samples that the mesh has not taken yet."""
        self.leave_after = 0.0
        """How long after their decision large samples leave, at most, as far as the last ones say [s]."""

    def renumber(self, places: Sequence[int | None]) -> None:
        """New limits are in force, which were at these places before; nothing was used of those that are new."""
        self.replace([(t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in self])
        self._leaving.clear()

    def note(self, now: float, use: tuple[float, ...], large: int | None) -> None:
        """A message is sent now, a `large` sample or something else."""
        self.add(now, use)
        if large is not None:
            self._leaving[large] = now, use

    def is_leaving(self, sample: int) -> bool:
        """Whether a sample is a large one that the mesh has not taken yet."""
        return sample in self._leaving

    def handed(self, now: float, sample: int) -> None:
        """The mesh took a sample: a large one counts from now on (else a window in four held up to 1.31 limits)."""
        send = self._leaving.pop(sample, None)
        if send is not None and self.remove(send):
            self.add(now, send[1])
            took, weight = now - send[0], TUNING.departure_weight
            self.leave_after = min(
                max(took, (1.0 - weight) * self.leave_after + weight * took), TUNING.longest_departure
            )

    def refused(self, sample: int) -> None:
        """The mesh did not take a sample."""
        self._leaving.pop(sample, None)


class OthersSends:
    """What others sent, by what it uses of each limit in force."""

    def __init__(self, traffic: TrafficLog) -> None:
        self._traffic = traffic
        self._log = SendLog()
        self._limits: tuple[Limit, ...] = ()
        self._taken = 0, 0
        """How many sends there were so far, and how many had been retracted."""

    def used(self, since: float, k: int, limits: tuple[Limit, ...]) -> float:
        """Return what it used of a limit since then, at most the longest window ago."""
        self._follow(limits)
        if not self._log:
            return 0.0
        self._log.forget(since - longest_window(limits))
        return self._log.used(since, k)

    def _follow(self, limits: tuple[Limit, ...]) -> None:
        """Take in what was noted since the last time; all of it under other limits, or when something was retracted."""
        traffic = self._traffic
        noted = traffic.noted, traffic.retracted
        if noted == self._taken and limits is self._limits:
            return
        sends, retracted = self._taken
        if limits != self._limits or retracted != traffic.retracted:
            self._log, sends = SendLog(), 0
        self._limits, self._taken = limits, noted
        for t, amount, _ in islice(traffic.sends, max(0, len(traffic.sends) - noted[0] + sends), None):
            self._log.add(t, use_of(*amount, limits, own=False))


def uses_of(now: float, sent: Collection[Entry], limits: tuple[Limit, ...], leave_after: float) -> tuple[Send, ...]:
    """Return what this used of each limit that others sent, whose samples take as long to leave as ours."""
    alike = {amount: use_of(*amount, limits, own=False) for amount in {amount for _, amount, _ in sent}}
    return tuple([(min(t + leave_after, max(t, now)), alike[amount]) for t, amount, _ in sent])
