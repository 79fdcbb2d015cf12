"""How our samples get to another robot, as it tells: how long they take, and how many get lost."""

from collections import deque

from proxy.core.protocol.messages import Echo
from proxy.core.transit.latency import Latency
from proxy.core.transit.offset import ClockOffset
from proxy.core.transit.tuning import TUNING


class Loss:
    """The share of samples lost within the recent past. A count that restarts begins a new past."""

    def __init__(self) -> None:
        self._read: deque[tuple[int, int]] = deque(maxlen=TUNING.loss_readings)

    @property
    def begun(self) -> bool:
        """Whether there was a reading since the last restart."""
        return bool(self._read)

    def read(self, sent: int, received: int) -> None:
        """So many were sent so far, and so many received."""
        if self._read and (sent < self._read[-1][0] or received < self._read[-1][1]):
            self._read.clear()
        if len(self._read) > 1 and self._read[-1][0] - self._read[-2][0] < TUNING.samples_between_readings:
            self._read.pop()
        if not self._read or self._read[-1] != (sent, received):
            self._read.append((sent, received))

    def restart(self) -> None:
        """Forget the counts: from now on other samples are counted."""
        self._read.clear()

    @property
    def counted(self) -> tuple[int, int]:
        """How many samples were sent in the recent past, and how many of these got lost."""
        if len(self._read) < 2:
            return 0, 0
        (sent, received), (sent_last, received_last) = self._read[0], self._read[-1]
        return sent_last - sent, max(0, sent_last - sent - (received_last - received))

    @property
    def share(self) -> float | None:
        """Part of the samples that got lost, from 0.0 to 1.0; None while nothing was sent."""
        return share_of(*self.counted)


def share_of(sent: int, lost: int) -> float | None:
    """Return the part of so many samples that got lost; None while nothing was sent."""
    return min(1.0, lost / max(sent, TUNING.fewest_samples)) if sent else None


class Outbound:
    """The samples that were sent to a robot, and those that came there; `offset` is of its clock."""

    def __init__(self, offset: ClockOffset) -> None:
        self._offset = offset
        self.sent = 0
        """Samples handed to the mesh for the robot."""
        self.received = 0
        """Samples of ours that it received, as it tells."""
        self.latency: Latency | None = None
        """What our samples take to it, as it tells; None while unknown."""
        self._marks: deque[tuple[float, int]] = deque(maxlen=TUNING.digests_awaiting_echoes)
        """Send times of our last digests, and `sent` then."""
        self.losses = Loss()

    @property
    def line(self) -> Latency | None:
        """What our samples take to the robot, else half of what digests take there and back; None while unknown."""
        return self.latency or self._offset.line

    def handed(self, count: int) -> None:
        """So many samples were handed to the mesh for the robot."""
        self.sent += count

    def sent_digest(self, at: float) -> None:
        """We send a digest: its echo will say what had arrived of what was sent by now."""
        self._marks.append((at, self.sent))

    def heard_echo(self, now: float, echo: Echo) -> None:
        """The robot tells what it got of us."""
        if echo.sent > now:
            return  # of a digest that we have not sent
        self._offset.echoed(echo.sent, echo.received)
        self.received, self.latency = echo.samples, latency_of(echo)
        sent = next((count for at, count in self._marks if abs(at - echo.sent) < TUNING.same_time), None)
        if sent is not None:
            self.losses.read(sent, echo.samples)

    def restart_losses(self) -> None:
        """Forget the counts: from now on the other robot counts other samples than we do."""
        self.losses.restart()


def latency_of(echo: Echo) -> Latency | None:
    """Return what an echo tells of the way; None when its sender does not know, or tells what cannot be."""
    possible = 0.0 <= echo.latency < TUNING.oldest_arrival and 0.0 <= echo.per_byte < TUNING.slowest_channel
    return Latency(echo.latency, echo.per_byte) if possible and (echo.latency or echo.per_byte) else None
