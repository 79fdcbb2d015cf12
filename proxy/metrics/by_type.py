"""What became of this robot's samples, by information type: however many keys there are, labels have few values.

A stream may be forgotten, or covered by another type, and its counts with it. Totals must not sink for that: Prometheus
would take it for a restart. So each look adds what was counted since the look before.
"""

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import Any

from proxy.metrics.metric import Status


@dataclass(slots=True)
class OfType:
    """The totals of one information type, and how many streams it covers now."""

    streams: int = 0
    generated: int = 0
    by_reason: Counter[str] = field(default_factory=Counter)


class ByType:
    """Adds up from one status to the next. What is forgotten between two looks is counted up to the first of them."""

    def __init__(self) -> None:
        self._types: defaultdict[str, OfType] = defaultdict(OfType)
        self._seen: dict[str, Status] = {}
        """Each stream as it was at the last look."""

    def take(self, status: Status) -> dict[str, Any]:
        """Take in a status; return the totals by the name of the type, as plain data."""
        ours = {stream["key"]: stream for stream in status["streams"] if stream["robot"] == status["robot"]}
        before, self._seen = self._seen, ours
        for of_type in self._types.values():
            of_type.streams = 0
        for key, stream in ours.items():
            self._add(stream, before.get(key))
        return {
            name: {"streams": each.streams, "generated": each.generated, "by_reason": dict(each.by_reason)}
            for name, each in self._types.items()
        }

    def _add(self, now: Status, before: Status | None) -> None:
        if before is None or before["generated"] > now["generated"]:  # it is new, or was forgotten and is back
            before = {"generated": 0, "by_reason": {}}
        of_type = self._types[now["type"]]
        of_type.streams += 1
        of_type.generated += now["generated"] - before["generated"]
        of_type.by_reason.update(
            {reason: count - before["by_reason"].get(reason, 0) for reason, count in now["by_reason"].items()}
        )
