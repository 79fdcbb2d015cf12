"""What came from other robots lately, where each sample counts: a copy of what is here already is left out.

A link that falls keeps to itself what it carried. So who sent it sends again what may have been lost, and who receives
it knows best. Samples are told apart by their timestamps, which are nobody else's.
"""

import threading
from collections import OrderedDict

import zenoh

from proxy.bridge.bounds import BOUNDS


class Received:
    """The timestamps of samples, by key, and whether each came as a copy. From any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: OrderedDict[str, OrderedDict[zenoh.Timestamp, bool]] = OrderedDict()

    def takes(self, key: str, stamp: zenoh.Timestamp | None, *, copy: bool) -> bool:
        """Whether a sample is not here yet, which it is from now on.

        Of two that did not come as copies none is left out: an application may publish with one timestamp twice.
        """
        if stamp is None:
            return True
        with self._lock:
            known = self._of(key)
            before = known.get(stamp)
            if before is not None and (before or copy):
                return False
            known[stamp] = copy
            if len(known) > BOUNDS.received_samples:
                known.popitem(last=False)
            return True

    def _of(self, key: str) -> OrderedDict[zenoh.Timestamp, bool]:
        known = self._known.pop(key, None)
        if known is None and len(self._known) >= BOUNDS.received_keys:
            self._known.popitem(last=False)
        self._known[key] = known = OrderedDict() if known is None else known
        return known
