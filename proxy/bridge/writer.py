"""Publishes samples on the mesh, one after the other, for `egress`."""

import logging
import math
from typing import Any

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.broadcast import DataSession
from proxy.bridge.demand import Demand
from proxy.bridge.sample import Held, publish
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.slow_links import SlowLinks

log = logging.getLogger(__name__)


class Writer:
    """The only writer of samples onto the mesh."""

    def __init__(self, session: DataSession, demand: Demand, buffers: SendBuffers) -> None:
        self._session = session
        self._demand = demand
        self._buffers = buffers
        self._slow_links = SlowLinks(buffers)
        self._failing = False
        self.risked = 0
        """Samples that should wait for every link, and may have been dropped on one."""
        self._said = -math.inf, 0
        """When that was said last [s], and how many there were."""

    @property
    def calm(self) -> bool:
        """Whether no link was waited for in vain lately."""
        return self._slow_links.calm

    def stop_waiting(self) -> None:
        """Wait for no link any more."""
        self._slow_links.stop_waiting()

    def wait(self, held: Held) -> bool:
        """Wait until links take a sample, on the thread that may be held up.

        Return whether it may be dropped on links that have no room for it.
        """
        if self._slow_links.calm and (self._buffers.alone or self._buffers.takes(held.size)):
            return False
        droppable = held.waits and self._slow_links.stays_full()
        if droppable:
            self._risk()
        if not self._slow_links.calm:
            self._slow_links.await_previous(held.size, self._demand.wanting(held.key))
        return droppable

    def write(self, held: Held, *, droppable: bool) -> bool:
        """Publish a sample; return whether the session took it. What nobody wants need not be published."""
        sample = held.sample
        key = keys.kept(held.to, held.key) if held.to else None
        if key is not None and not keys.fits(key):
            return False
        outlet = None if held.to else self._demand.outlet(held.key)
        try:
            if outlet is None and not held.to and self._demand.silent(held.key):
                return True
            if outlet is not None and not droppable and outlet.suits(sample):
                # Most samples have neither, and Zenoh looks at whatever it is given.
                rest: dict[str, Any] = {} if held.source is None else {"source_info": held.source}
                if (attachment := sample.attachment) is not None:
                    rest["attachment"] = attachment
                outlet.publisher.put(sample.payload, encoding=sample.encoding, timestamp=held.stamp, **rest)
            else:
                publish(self._session, sample, held.stamp, key, source=held.source, droppable=droppable)
        except (zenoh.ZError, RuntimeError) as error:  # RuntimeError: the publisher is being taken back
            if not self._failing:
                log.error("the mesh session refuses %s: %s", held.key, error)
            self._failing = True
            return False
        self._failing = False
        return True

    def _risk(self) -> None:
        """A sample may be dropped on a link that is slower than the others."""
        self.risked += 1
        said_at, said = self._said
        if clock.monotonic() - said_at >= BOUNDS.warnings_apart:
            self._said = clock.monotonic(), self.risked
            log.warning(
                "a link takes much less than the others; samples that may have been lost there since that was said: %d",
                self.risked - said,
            )
