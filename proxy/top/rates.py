"""What happens in a second: the difference between two statuses of one daemon."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from proxy.quantities import Status

DROPPED = "dropped:"


@dataclass(frozen=True, slots=True)
class Change:
    """The last status of a daemon, and the one before, if there was one."""

    now: Status
    before: Status | None = None

    def then(self, status: Status) -> "Change":
        """Return the change that another status makes; a daemon that started anew begins anew."""
        again = status.get("uptime", 0.0) < self.now.get("uptime", 0.0)
        return Change(status, None if again else self.now)

    @property
    def seconds(self) -> float:
        """How much time lies between the two, by the daemon's own clock [s]; 0.0 without a first one."""
        return 0.0 if self.before is None else float(self.now.get("uptime", 0.0) - self.before.get("uptime", 0.0))

    def rate(self, part: str, name: str) -> float | None:
        """Return by how much a number of a part grows in a second; None while unknown."""
        return self._growth(self.now.get(part, {}), {} if self.before is None else self.before.get(part, {}), name)

    def mean(self, part: str, name: str, of: str) -> float | None:
        """Return how much of a number there was for each of another one, lately; None while there was none."""
        more, each = self.rate(part, name), self.rate(part, of)
        return more / each if more is not None and each else None

    def dropped(self) -> dict[str, float]:
        """Return how many samples are dropped in a second, by reason, most first."""
        old = None if self.before is None else self.before.get("counts", {}).get("by_reason", {})
        return self._reasons(self.now.get("counts", {}).get("by_reason", {}), old)

    def streams(self) -> Iterator[dict[str, Any]]:
        """Yield each stream with its rates: `made`, `sent`, `unsent` [1/s], `bytes` [B/s], and `why`."""
        old = {} if self.before is None else {_place(each): each for each in self.before.get("streams", ())}
        for stream in self.now.get("streams", ()):
            was = old.get(_place(stream))
            over = self._span(stream, was)
            made, sent = (self._growth(stream, was, name, over) for name in ("generated", "forwarded"))
            yield {
                **stream,
                "made": made,
                "sent": sent,
                "unsent": None if made is None or sent is None else max(0.0, made - sent),
                "bytes": None if sent is None else sent * stream.get("size", 0),
                "why": self._reasons(stream.get("by_reason", {}), None if was is None else was.get("by_reason", {})),
            }

    def _span(self, now: Status, before: Status | None) -> float:
        """Return the time in which a stream's counts grew [s]: of what others tell now and then, from news to news."""
        was, age = None if before is None else before.get("last_generated"), now.get("last_generated")
        if now.get("robot") == self.now.get("robot") or was is None or age is None:
            return self.seconds
        span = float(self.seconds + was - age)
        return span if span > 0.0 else self.seconds

    def _growth(self, now: Status, before: Status | None, name: str, over: float | None = None) -> float | None:
        seconds = self.seconds if over is None else over
        if seconds <= 0.0 or before is None:
            return None
        return max(0.0, float(now.get(name, 0) - before.get(name, 0)) / seconds)

    def _reasons(self, now: Mapping[str, int], before: Mapping[str, int] | None) -> dict[str, float]:
        rates = {word: self._growth(now, before, word) or 0.0 for word in now if word.startswith(DROPPED)}
        return {word: rate for word, rate in sorted(rates.items(), key=lambda each: -each[1]) if rate}


def _place(stream: Status) -> tuple[str, str]:
    return str(stream.get("robot")), str(stream.get("key"))
