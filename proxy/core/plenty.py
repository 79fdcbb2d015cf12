"""Plenty: while the limits have room for all that robots generate, each is lent what it needs, and more, for long.

Then nothing has to be planned for anybody else, no sample waits for what it takes to be lent, and none needs a search.
While nobody generates anything there is plenty, too: streams that begin find room at once. When streams come or grow
until there is none any more, what was lent so is not lengthened, and runs out.
"""

import math
from collections.abc import Sequence

from proxy.core.ample import EACH, PACE, Amounts, need
from proxy.core.limits import Limit
from proxy.core.shares import Lent, Shares
from proxy.core.slots import LASTS, LONGEST, RENEWED, lengthened_by
from proxy.core.view import SharedView

ENOUGH = 0.5
"""There is plenty when all together need no more than this part of every limit..."""
STAYS = 0.7
"""... and still when they need a little more."""
CALM = 2.0
"""It must have been so for so long: what new streams need is not known at once [s]."""
SPARED = 0.9
"""So much of the rest is given out, too; each robot gets the same of it."""


class Plenty:
    """Whether there is plenty, and what we lend of it as leader."""

    def __init__(self, view: SharedView, shares: Shares) -> None:
        self._view = view
        self._shares = shares
        self._due = -math.inf
        self._there = False
        self._enough_since = math.inf
        self._needs: dict[str, Amounts] = {}
        self._limits = 0
        self._lent: dict[str, list[Lent]] = {}

    def there(self, now: float, limits: Sequence[Limit]) -> bool:
        """Whether the limits that robots share have room for all that is wanted of anybody."""
        if now < self._due:
            return self._there
        streams = self._view.competition.all(now)
        self._due = now + max(PACE, EACH * len(streams))
        self._needs, self._limits = {}, len(limits)
        for stream in streams:
            known = self._needs.get(stream.robot, (0.0,) * len(limits))
            self._needs[stream.robot] = _sum(known, need(self._view, stream, limits, now))
        part = STAYS if self._there else ENOUGH
        enough = bool(limits) and all(left >= 1.0 - part for left in self._left(len(limits)))
        self._enough_since = min(self._enough_since, now) if enough else math.inf
        self._there = now >= self._enough_since + CALM
        return self._there

    def lend(self, now: float) -> int:
        """Lend each robot what it needs and a part of the rest, and lengthen that; return how often."""
        alive, done = set(self._shares.lent(now)), 0
        limits = self._limits
        spare = tuple(
            SPARED * left * self._shares.whole(k) / (len(self._view.peers) + 1)
            for k, left in enumerate(self._left(limits))
        )
        for tag, peer in self._view.peers.items():
            if not peer.offset.known:
                continue
            lent = self._lent[tag] = [each for each in self._lent.get(tag, ()) if each in alive]
            until = lengthened_by(now, peer.offset)
            for each in [each for each in lent if each.ends < until and each.ends - each.begins < LONGEST]:
                if (longer := self._shares.lengthen(now, each, until + RENEWED)) is not None:
                    lent[lent.index(each)] = longer
                    done += 1
            needed = self._needs.get(peer.robot, (0.0,) * limits)
            held = _sum((0.0,) * limits, *(each.amounts for each in lent if each.ends >= until))
            if not lent or any(have < amount for have, amount in zip(held, needed, strict=True)):
                wanted = tuple(max(0.0, n + s - h) for n, s, h in zip(needed, spare, held, strict=True))
                if (new := self._shares.lend(now, tag, now, until + RENEWED, wanted, lasting=LASTS)) is not None:
                    lent.append(new)
                    done += 1
        return done

    def _left(self, limits: int) -> list[float]:
        """What part of each limit nobody needs."""
        needed = _sum((0.0,) * limits, *self._needs.values())
        return [1.0 - amount / max(self._shares.whole(k), 1e-9) for k, amount in enumerate(needed)]


def _sum(*amounts: Amounts) -> Amounts:
    return tuple(map(sum, zip(*amounts, strict=True)))
