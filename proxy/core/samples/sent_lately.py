"""Samples sent lately of which each counts: a robot whose loss is noticed now may not have got them."""

import math
from collections.abc import Mapping

from proxy.core.samples.away import Copy, Leaving
from proxy.core.samples.held_payloads import HeldPayloads
from proxy.core.samples.tuning import TUNING


class SentLately:
    """Of each key as many as are kept for one robot."""

    def __init__(self, payloads: HeldPayloads) -> None:
        self._payloads = payloads
        self._sent: dict[str, dict[int, tuple[Copy, Mapping[str, float]]]] = {}
        """By key and sample: a copy of it for anybody, and by tag when it was sent to which robots [s]."""

    def __bool__(self) -> bool:
        return bool(self._sent)

    def note(self, copy: Copy, at: Mapping[str, float]) -> None:
        """A sample was sent at these times to these robots."""
        waiting = copy.waiting
        many = self._sent.setdefault(waiting.key, {})
        if waiting.sample not in many:
            self._payloads.hold(waiting)
        _, before = many.pop(waiting.sample, (copy, {}))
        many[waiting.sample] = copy, {**before, **at}
        if len(many) > copy.most:
            self.forget(waiting.key, next(iter(many)))

    def doubtful(self, now: float, robot: Leaving) -> list[Copy]:
        """Return what a robot that vanishes now may not have got; nothing if it would not notice what it has."""
        if not robot.alike:
            return []
        since, sent = now - TUNING.doubtful, (each for many in self._sent.values() for each in many.values())
        return [copy for copy, at in sent if at.get(robot.tag, -math.inf) >= since]

    def forget(self, key: str, sample: int) -> None:
        """Nobody needs a sample any more."""
        many = self._sent.get(key, {})
        if many.pop(sample, None) is not None:
            if not many:
                del self._sent[key]
            self._payloads.release(sample)

    def forget_oldest(self) -> None:
        """There is no room for all: one leaves."""
        key, many = next(iter(self._sent.items()))
        self.forget(key, next(iter(many)))

    def sweep(self, now: float) -> None:
        """Forget what has arrived for certain."""
        since = now - TUNING.doubtful
        old = [(k, n) for k, many in self._sent.items() for n, (_, at) in many.items() if max(at.values()) < since]
        for key, sample in old:
            self.forget(key, sample)
