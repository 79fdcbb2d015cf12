"""Conservation of samples: those that came in = forwarded + dropped (each with a reason) + queued, at any time."""

import math
from collections import Counter
from collections.abc import Collection

from proxy.core.interface.commands import Notice
from proxy.core.samples.tuning import TUNING

DROPPED = "dropped:"


class Counts:
    """Counts every sample that entered on the app side, once, by what became of it."""

    def __init__(self) -> None:
        self.received = 0
        self.by_reason: Counter[str] = Counter()
        self.bytes: Counter[str] = Counter()
        """What samples that passed without a decision took on the air, by reason [B]."""
        self.generated: Counter[str] = Counter()
        """Samples by the information type that covered them; a stream that is forgotten leaves its part."""
        self.decided: Counter[tuple[str, str]] = Counter()
        """What was decided on them, by type and reason."""
        self._queued: dict[int, tuple[str, str]] = {}
        """The keys of samples, and why each was approved, if it was."""

    def enter(self, sample: int, key: str = "") -> None:
        """A sample came in and is queued; the `key` is of one of ours."""
        self.received += 1
        self._queued[sample] = key, ""

    def approve(self, sample: int, reason: str) -> None:
        """The sample was approved for `reason`; it stays queued until it is handed over."""
        self._queued[sample] = self._queued[sample][0], reason

    def forward(self, sample: int, key: str, reason: str) -> None:
        """A sample of ours came in, and is approved at once."""
        self.received += 1
        self._queued[sample] = key, reason

    def key_of(self, sample: int) -> str:
        """Return the key of a sample that is queued, if it is one of ours."""
        return self._queued[sample][0]

    def approved(self, sample: int) -> str:
        """Return why a sample that is queued was approved; nothing if it is not."""
        return self._queued[sample][1]

    def hand(self, sample: int) -> str:
        """The mesh session took the sample; return its key."""
        key, reason = self._queued.pop(sample)
        self.by_reason[reason] += 1
        return key

    def drop(self, sample: int, reason: str) -> str:
        """The sample was dropped; return its key."""
        key, _ = self._queued.pop(sample)
        self.by_reason[reason] += 1
        return key

    def generate(self, type_: str, count: int) -> None:
        """So many samples of an information type were generated."""
        self.generated[type_] += count

    def decide(self, type_: str, reason: str, count: int) -> None:
        """So many samples of an information type were decided on."""
        self.decided[type_, reason] += count

    def retain(self, types: Collection[str]) -> None:
        """There are only these information types from now on: what was counted of others goes."""
        self.generated = Counter({name: count for name, count in self.generated.items() if name in types})
        self.decided = Counter({place: count for place, count in self.decided.items() if place[0] in types})

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
        """Whether every sample is accounted for."""
        return self.received == self.forwarded + self.dropped + self.queued


REASONS = {
    "dropped:overflow": "too many waited to be decided",
    "dropped:full": "too many waited for the mesh",
    "dropped:too-large": "they are larger than a message may be on the mesh",
    "dropped:egress": "the mesh session did not take them",
}


class Unplanned:
    """Looks at what was counted."""

    def __init__(self, counts: Counts) -> None:
        self._counts = counts
        self._said = dict.fromkeys(REASONS, 0)
        self._next = dict.fromkeys(REASONS, -math.inf)

    def look(self, now: float) -> list[Notice]:
        """Return what is to be said."""
        dropped = self._counts.by_reason
        return [
            self._notice(now, reason)
            for reason, said in self._said.items()
            if dropped[reason] > said and now >= self._next[reason]
        ]

    def _notice(self, now: float, reason: str) -> Notice:
        total = self._counts.by_reason[reason]
        new, self._said[reason], self._next[reason] = total - self._said[reason], total, now + TUNING.warnings_apart
        text = f"samples dropped, {REASONS[reason]}: {new}, {total} in all ({reason})"
        return Notice("warning", text, {"reason": reason, "new": new, "total": total})
