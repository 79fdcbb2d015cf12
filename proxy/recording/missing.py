"""Counts what a recording does not have."""

from collections import Counter

from proxy.core.interface.events import Event, SamplePublished
from proxy.recording.entries import Gap


class Missing:
    """Events in a row that are missing for a `reason`, and payloads of any events."""

    def __init__(self, reason: str = "") -> None:
        self.reason = reason
        self.first: int | None = None
        self.by_event = Counter[str]()
        self.payloads = 0

    def event(self, number: int, event: Event) -> None:
        """Count an event; of several in their order."""
        if self.first is None:
            self.first = number
        self.by_event[type(event).__name__] += 1

    def payload(self) -> None:
        """Count a payload."""
        self.payloads += 1

    def follow(self, other: "Missing") -> None:
        """Count what another one counts, which comes next."""
        if self.first is None:
            self.first = other.first
        self.by_event += other.by_event
        self.payloads += other.payloads
        self.reason = self.reason or other.reason

    @property
    def events(self) -> int:
        """How many are missing."""
        return self.by_event.total()

    def gap(self, due: int) -> Gap:
        """Return what the recording says of it; where no event is missing the next one is `due`."""
        first = due if self.first is None else self.first
        samples = self.by_event[SamplePublished.__name__]
        return Gap(first, self.events, samples, self.payloads, self.reason, dict(self.by_event))

    def __bool__(self) -> bool:
        """Whether anything is missing."""
        return bool(self.by_event or self.payloads)
