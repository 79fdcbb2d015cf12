"""What counts against the limits: our own sends, and what we know others to have sent."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterator, Sequence
from itertools import islice

from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, Send, longest_window, use_of
from proxy.core.view.peer import Entry
from proxy.core.view.traffic import TrafficLog


class SendLog:
    """Sends in the order of their times, and what those since any moment use of each limit: two look-ups, no sum."""

    def __init__(self, changes: int = 0) -> None:
        self._times: list[float] = []
        self._uses: list[tuple[float, ...]] = []
        self._sums: list[tuple[float, ...]] = []
        """What each send and all before it use together, as far as they are remembered."""
        self._first = 0
        """Those before this place are forgotten: they are taken away when they are as many as those that are left."""
        self.changes = changes
        """How often a send was added or taken out; that one is forgotten changes nothing that still counts."""

    def __len__(self) -> int:
        return len(self._times) - self._first

    def __iter__(self) -> Iterator[Send]:
        """Oldest first."""
        return iter(list(zip(self._times[self._first :], self._uses[self._first :], strict=True)))

    def since(self, t: float) -> list[Send]:
        """Return what was sent since then, oldest first."""
        place = bisect_left(self._times, t, lo=self._first)
        return list(zip(self._times[place:], self._uses[place:], strict=True))

    def add(self, t: float, use: tuple[float, ...]) -> None:
        """Something was sent at `t` [s]."""
        place = bisect_right(self._times, t, lo=self._first)
        self._times.insert(place, t)
        self._uses.insert(place, use)
        self._sum_up(place)

    def remove(self, send: Send) -> bool:
        """Forget one send; return whether it was there."""
        place = bisect_left(self._times, send[0], lo=self._first)
        while place < len(self._times) and self._times[place] == send[0]:
            if self._uses[place] == send[1]:
                del self._times[place], self._uses[place]
                self._sum_up(place)
                return True
            place += 1
        return False

    def forget(self, before: float) -> None:
        """Of what was sent before this nothing counts any more."""
        self._first = bisect_left(self._times, before, lo=self._first)
        if 2 * self._first > len(self._times):
            del self._times[: self._first], self._uses[: self._first]
            self._first = 0
            self._sum_up(0)

    def used(self, since: float, k: int) -> float:
        """Return what was used of a limit since then."""
        place = bisect_left(self._times, since, lo=self._first)
        if place == len(self._times):
            return 0.0
        return self._sums[-1][k] - (self._sums[place - 1][k] if place else 0.0)

    def exceeded_since(self, k: int, amount: float) -> float:
        """Return when that was sent with which all later sends use more than an amount of limit `k` [s]; else −∞."""
        sums = self._sums
        least = sums[-1][k] - amount if sums else 0.0
        if least <= 0.0:
            return -math.inf
        return self._times[bisect_left(sums, least, key=lambda used: used[k])]

    def _sum_up(self, place: int) -> None:
        """Sum up anew from this place on."""
        self.changes += 1
        del self._sums[place:]
        total = self._sums[-1] if self._sums else ()
        for use in self._uses[place:]:
            total = tuple([a + b for a, b in zip(total, use, strict=True)]) if total else use
            self._sums.append(total)


class OwnSends:
    """Our sends, by what they use of each limit in force."""

    def __init__(self) -> None:
        self._sent = SendLog()
        self._leaving: dict[int, Send] = {}
        """Of these, large samples that the mesh has not taken yet."""
        self.leave_after = 0.0
        """How long after their decision large samples leave, at most, as far as the last ones say [s]."""

    def __iter__(self) -> Iterator[Send]:
        """Oldest first."""
        return iter(self._sent)

    @property
    def changes(self) -> int:
        """How often they changed."""
        return self._sent.changes

    def since(self, t: float) -> list[Send]:
        """Return what was sent since then, oldest first."""
        return self._sent.since(t)

    def renumber(self, places: Sequence[int | None]) -> None:
        """New limits are in force, which were at these places before; nothing was used of those that are new."""
        before, self._sent = self._sent, SendLog(self._sent.changes + 1)
        for t, use in before:
            self._sent.add(t, tuple(0.0 if k is None else use[k] for k in places))
        self._leaving.clear()

    def exceeded_since(self, k: int, amount: float) -> float:
        """Return when that was sent with which all later sends use more than an amount of limit `k` [s]; else −∞."""
        return self._sent.exceeded_since(k, amount)

    def note(self, now: float, use: tuple[float, ...], large: int | None) -> None:
        """A message is sent now, a `large` sample or something else."""
        self._sent.add(now, use)
        if large is not None:
            self._leaving[large] = now, use

    def forget(self, before: float) -> None:
        """Of what was sent before this nothing counts any more."""
        self._sent.forget(before)

    def used(self, since: float, k: int) -> float:
        """Return what they used of a limit since then."""
        return self._sent.used(since, k)

    def is_leaving(self, sample: int) -> bool:
        """Whether a sample is a large one that the mesh has not taken yet."""
        return sample in self._leaving

    def handed(self, now: float, sample: int) -> None:
        """The mesh took a sample: a large one counts from now on (else a window in four held up to 1.31 limits)."""
        send = self._leaving.pop(sample, None)
        if send is not None and self._sent.remove(send):
            self._sent.add(now, send[1])
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
