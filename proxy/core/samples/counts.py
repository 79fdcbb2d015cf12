"""The law of conservation: samples in = forwarded + dropped (each with a reason) + queued, at every instant."""

from collections import Counter

DROPPED = "dropped:"


class Counts:
    """Counts every sample that entered on the app side, once, by what became of it."""

    def __init__(self) -> None:
        self.received = 0
        self.by_reason: Counter[str] = Counter()
        self.bytes: Counter[str] = Counter()
        """What passed without a decision put on the air, by reason [B]."""
        self._queued: dict[int, str] = {}

    def enter(self, sample: int) -> None:
        """A sample came in and is queued."""
        self.received += 1
        self._queued[sample] = ""

    def approve(self, sample: int, reason: str) -> None:
        """The sample was approved for `reason`; it stays queued until it is handed over."""
        self._queued[sample] = reason

    def hand(self, sample: int) -> None:
        """The mesh session took the sample."""
        self.by_reason[self._queued.pop(sample)] += 1

    def drop(self, sample: int, reason: str) -> None:
        """The sample was dropped."""
        del self._queued[sample]
        self.by_reason[reason] += 1

    def passed(self, count: int, reason: str, size: int = 0) -> None:
        """`count` samples went through at once, `size` bytes of the air in all."""
        self.received += count
        self.by_reason[reason] += count
        self.bytes[reason] += size

    @property
    def queued(self) -> int:
        """Samples that wait for a decision or to be handed over."""
        return len(self._queued)

    @property
    def dropped(self) -> int:
        """Samples that were dropped."""
        return sum(n for reason, n in self.by_reason.items() if reason.startswith(DROPPED))

    @property
    def forwarded(self) -> int:
        """Samples that were handed to the mesh session."""
        return sum(n for reason, n in self.by_reason.items() if not reason.startswith(DROPPED))

    @property
    def conserved(self) -> bool:
        """Whether the law holds."""
        return self.received == self.forwarded + self.dropped + self.queued
