"""Digests of robots whose presence is not known yet: they may overtake it."""

from proxy.core.protocol.messages import Digest
from proxy.core.view.tuning import TUNING


class UnknownSenders:
    """Keeps the last digests of each unknown sender until it appears; `forgotten` counts what had no room."""

    def __init__(self) -> None:
        self._heard: dict[str, list[tuple[float, Digest]]] = {}
        self.forgotten = 0

    def keep(self, now: float, digest: Digest) -> None:
        """Keep an unknown sender's digest; the sender heard of longest ago has to leave for a new one."""
        kept = self._heard.pop(digest.tag, [])
        self._heard[digest.tag] = kept
        kept.append((now, digest))
        if len(kept) > TUNING.unknown_digests:
            del kept[0]
            self.forgotten += 1
        if len(self._heard) > TUNING.unknown_senders:
            self.forgotten += len(self._heard.pop(next(iter(self._heard))))

    def introduce(self, tag: str) -> list[tuple[float, Digest]]:
        """Return what a robot said before we knew of it, oldest first, each with its receipt time."""
        return self._heard.pop(tag, [])
