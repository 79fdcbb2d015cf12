"""Counts what a recording does not have."""

from collections import Counter
from collections.abc import Iterable

from proxy.core.interface.events import Event, SamplePublished
from proxy.recording.entries import Gap

_MANY = 4096


class Missing:
    """Events in a row that are missing for a `reason`, and payloads of any events."""

    def __init__(self, reason: str = "") -> None:
        self.reason = reason
        self.first: int | None = None
        """The number of the first one."""
        self.payloads = 0
        self._counts = Counter[type[Event]]()
        self._kinds: list[type[Event]] = []
        """Of those that are not in the counts yet: of every event that is written it is counted what it is."""

    def event(self, number: int, event: Event) -> None:
        """Count an event; of several in their order."""
        if self.first is None:
            self.first = number
        self._kinds.append(type(event))
        if len(self._kinds) >= _MANY:
            self._count()

    def all_events(self, first: int, events: Iterable[Event]) -> None:
        """Count events in a row, from number `first` on."""
        if self.first is None:
            self.first = first
        self._kinds += map(type, events)
        if len(self._kinds) >= _MANY:
            self._count()

    def payload(self) -> None:
        """Count a payload."""
        self.payloads += 1

    def follow(self, other: "Missing", reason: str = "") -> None:
        """Count what another one counts, which comes next; all is missing for this `reason` where one is given."""
        if self.first is None:
            self.first = other.first
        self.by_kind.update(other.by_kind)
        self.payloads += other.payloads
        self.reason = reason or self.reason or other.reason

    @property
    def by_kind(self) -> Counter[type[Event]]:
        """How many of which class are missing."""
        self._count()
        return self._counts

    @property
    def events(self) -> int:
        """How many are missing."""
        return self.by_kind.total()

    def gap(self, due: int) -> Gap:
        """Return what the recording says of it; where no event is missing the next one is `due`."""
        first = due if self.first is None else self.first
        by_event = {kind.__name__: count for kind, count in self.by_kind.items()}
        return Gap(first, self.events, self.by_kind[SamplePublished], self.payloads, self.reason, by_event)

    def __bool__(self) -> bool:
        """Whether anything is missing."""
        return self.first is not None or self.payloads > 0

    def _count(self) -> None:
        self._counts.update(self._kinds)
        self._kinds.clear()
