"""Receives every sample that an app publishes, stamps it and queues it. Never decides, never blocks."""

import itertools
import logging
from collections.abc import Callable

import zenoh

from proxy import clock
from proxy.bridge.declaration import Declaration
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.keys import INGRESS
from proxy.bridge.passed import MODE, NO_SPEC, OVERFLOW, Passed
from proxy.bridge.sample import Held, generated, origin_of, priority_of
from proxy.core.events import SamplePublished
from proxy.core.mode import Mode
from utility_specs import InformationType

log = logging.getLogger(__name__)

MOST_HELD = 4096
"""Samples held for the core, which has a bound of its own; this one holds when the loop stalls."""

Submit = Callable[[SamplePublished, InformationType, zenoh.ZBytes], None]


class Ingress:
    """Subscribes to everything on the app side and sorts it: the core gets what is covered, the rest passes.

    Covered samples are held until `release`. `submit` gets them for the core, with the type that covers them.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        mesh: zenoh.Session,
        match: Callable[[str], InformationType | None],
        egress: Egress,
        demand: Demand,
        passed: Passed,
        submit: Submit,
        mode: Mode,
    ) -> None:
        self.mode = mode
        self.aside = False
        """Whether another daemon takes care of our apps: then everything is left to it."""
        self._app = app
        self._mesh = mesh
        self._match = match
        self._egress = egress
        self._demand = demand
        self._passed = passed
        self._submit = submit
        self._numbers = itertools.count(1)
        self._held: dict[int, Held] = {}
        self._own = str(mesh.zid())
        self.returned = 0
        """Samples that left here for the mesh and came back around the daemons."""
        self._subscribers: list[Declaration] = []

    def open(self) -> None:
        """Start receiving."""
        handler = zenoh.handlers.Callback(self._receive, indirect=False)
        self._subscribers = [
            self._app.declare_subscriber(key, handler, allowed_origin=zenoh.Locality.REMOTE) for key in INGRESS
        ]

    def close(self) -> None:
        """Receive nothing more."""
        for subscriber in self._subscribers:
            subscriber.undeclare()
        self._subscribers = []

    def release(self, number: int) -> Held | None:
        """Give out a held sample; None when it is not held (any more)."""
        return self._held.pop(number, None)

    @property
    def held(self) -> int:
        """Samples that wait for the core's answer."""
        return len(self._held)

    def _receive(self, sample: zenoh.Sample) -> None:
        now = clock.monotonic()
        key = str(sample.key_expr)
        stamp = sample.timestamp
        if self.aside:
            return
        if stamp is not None and origin_of(stamp) == self._own:
            self.returned += 1
            return
        held = Held(sample, stamp or self._mesh.new_timestamp(), key, len(sample.payload))
        covering = self._match(key)
        self._demand.note(key, covered=covering is not None)
        if covering is None:
            self._egress.pass_on(NO_SPEC, held)
        elif self.mode is Mode.PASS:
            self._egress.pass_on(MODE, held)
        else:
            self._hold(now, held, stamp, covering)

    def _hold(self, now: float, held: Held, stamp: zenoh.Timestamp | None, covering: InformationType) -> None:
        if len(self._held) >= MOST_HELD:
            self._passed.add(OVERFLOW, 0)
            return
        number = next(self._numbers)
        self._held[number] = held
        published = SamplePublished(
            now=now,
            sample=number,
            key=held.key,
            size=held.size,
            t_gen=generated(stamp, now, clock.wall()),
            origin=None if stamp is None else origin_of(stamp),
            priority=priority_of(held.sample),
            features={},
            delete=held.sample.kind == zenoh.SampleKind.DELETE,
        )
        self._submit(published, covering, held.sample.payload)
