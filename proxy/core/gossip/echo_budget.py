"""Whose digests are echoed, within the part of the allowance that echoes may take."""

import math
from collections.abc import Iterable

from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import Echo


class EchoBudget:
    """Echoes in turn: of those robots first that were not echoed for longest."""

    def __init__(self) -> None:
        self._left = TUNING.echoes_ahead
        """What echoes may take now [B]."""
        self._echoed: dict[str, float] = {}
        """When each robot was echoed last [s]."""

    def gain(self, size: float, most: float) -> None:
        """The allowance brought so many bytes for ordinary news; echoes save their part of them, up to `most`."""
        self._left = min(max(most, TUNING.echoes_ahead), self._left + TUNING.echoes * size)

    def affords(self, copies: int) -> int:
        """Return how many echoes a digest of so many copies has room for."""
        return min(TUNING.echoed, int(self._left / (TUNING.echo * max(1, copies))))

    def take(self, now: float, echoes: Iterable[Echo], copies: int) -> tuple[Echo, ...]:
        """Return some of the echoes, for a digest of so many copies that goes out now."""
        known = {echo.peer: echo for echo in echoes}
        self._echoed = {peer: at for peer, at in self._echoed.items() if peer in known}
        due = [peer for peer in known if now >= self._echoed.get(peer, -math.inf) + TUNING.slowest_digest]
        chosen = sorted(due, key=lambda peer: self._echoed.get(peer, -math.inf))[: self.affords(copies)]
        self._left -= TUNING.echo * copies * len(chosen)
        self._echoed.update(dict.fromkeys(chosen, now))
        return tuple(known[peer] for peer in chosen)
