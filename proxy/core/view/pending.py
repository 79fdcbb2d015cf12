"""News of streams whose keys are not known yet: a digest may arrive before the state that names its streams."""

from collections.abc import Container

from proxy.core.protocol.messages import StreamDigest
from proxy.core.view.tuning import TUNING

Entry = tuple[float, tuple[int, int]]
"""When a sample was sent [s], and what it counts as: bytes and copies."""


class PendingNews:
    """The last news of each such stream of one robot; `evicted` counts those for which there was no room."""

    def __init__(self) -> None:
        self._news: dict[int, StreamDigest] = {}
        self._counted: dict[int, Entry] = {}
        """What was last sent of them, as the traffic log counts it."""
        self.evicted = 0

    def __len__(self) -> int:
        return len(self._news)

    def keep(self, news: StreamDigest) -> bool:
        """Keep news; return whether it tells of another sample that was sent."""
        earlier = self._news.get(news.id)
        if earlier is None and len(self._news) >= TUNING.pending_news:
            self.evicted += 1
            return False
        self._news[news.id] = news
        return news.forwarded > (0 if earlier is None else earlier.forwarded)

    def count(self, number: int, entry: Entry) -> None:
        """What was sent of the stream with this number counts as this."""
        self._counted[number] = entry

    def named(self, numbers: Container[int]) -> list[tuple[StreamDigest, Entry | None]]:
        """Return the news of those streams whose keys are known now, each with what it counted as."""
        found = [number for number in self._news if number in numbers]
        return [(self._news.pop(number), self._counted.pop(number, None)) for number in found]
