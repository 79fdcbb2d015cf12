"""Receives the samples of apps that somebody on the mesh wants, stamps them and passes them on or holds them.

Never decides, and never waits for a mesh that stands still.
"""

from collections.abc import Collection, Iterable
from functools import partial
from typing import Protocol

import zenoh

from proxy import clock
from proxy.bridge.attached import attach
from proxy.bridge.barrier import Barrier
from proxy.bridge.courses import Courses
from proxy.bridge.cover import Cover
from proxy.bridge.declaration import Declaration
from proxy.bridge.deduplication import Deduplication, of_sample
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.mirror import Mirror
from proxy.bridge.passed import DENIED, OVERFLOW, TOO_LARGE, Passed
from proxy.bridge.payloads import Payloads
from proxy.bridge.room import Room
from proxy.bridge.rules import Rules
from proxy.bridge.sample import Held, generated, origin_of, priority_of, size_of
from proxy.bridge.stamped import Stamped
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import SamplePublished
from utility_specs import InformationType


class Submit(Protocol):
    """Takes a sample for the core; returns the number of one that it need not be told of any more."""

    def __call__(
        self,
        event: SamplePublished,
        covering: InformationType,
        payload: zenoh.ZBytes,
        attachment: zenoh.ZBytes | None,
        *,
        each: bool,
    ) -> int | None:
        """`each`: the core must be told of each sample."""


class Ingress:
    """Subscribes on the app side to what the mesh wants and sorts it: the core gets what is covered, the rest passes.

    No payload is larger than `largest` [B]. Covered samples wait among the `payloads`, as far as there is `room`.
    `submit` gets them for the core, with the type that covers them. What `barrier` holds goes when that lets it.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        mesh: zenoh.Session,
        courses: Courses,
        egress: Egress,
        demand: Demand,
        passed: Passed,
        rules: Rules,
        submit: Submit,
        payloads: Payloads,
        room: Room,
        largest: int,
        barrier: Barrier,
    ) -> None:
        self._aside = False
        """Whether another daemon takes care of our apps: then everything is left to it."""
        self._app = app
        self._mesh = mesh
        self._courses = courses
        self._egress = egress
        self._demand = demand
        self._passed = passed
        self._rules = rules
        self._submit = submit
        self._payloads = payloads
        self._room = room
        self._largest = largest
        self._barrier = barrier
        self._cover = Cover()
        self._deduplication = Deduplication(of_sample)
        self._mirror = Mirror(self._subscribe, TUNING.grace)
        self._own = str(mesh.zid())
        self._stamped = Stamped()
        self.returned = 0
        """Samples that left here for the mesh and came back around the daemons."""

    @property
    def declared(self) -> Collection[str]:
        """What we subscribe to on the app side for the mesh."""
        return self._mirror.declared

    @property
    def leaving(self) -> bool:
        """Whether something waits to be taken back: `update` has to be called again."""
        return self._mirror.leaving

    def update(self, wanted: Iterable[str]) -> bool:
        """Receive exactly what `wanted` matches, each sample once; return whether that is news.

        What is subscribed to stays while it is wanted, though something wider is subscribed to by now: Zenoh loses
        samples on their way when one of two subscriptions that match them is undeclared.
        """
        wanted = set(wanted)
        stay = dict.fromkeys(wanted.intersection(self._mirror.declared), False)
        return self._mirror.update(self._cover.update(wanted) | stay)

    def stand_aside(self, aside: bool) -> bool:  # noqa: FBT001 - a state, not an option
        """Leave everything to another daemon from now on, or no longer; return whether that is news."""
        before, self._aside = self._aside, aside
        return aside is not before

    def close(self) -> None:
        """Receive nothing more."""
        self._mirror.close()

    def _subscribe(self, expression: str, _complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        subscribe = partial(self._app.declare_subscriber, expression, allowed_origin=zenoh.Locality.REMOTE)
        return self._deduplication.declare(expression, self._receive, subscribe)

    def _receive(self, number: int, sample: zenoh.Sample) -> None:
        attach()
        now = clock.monotonic()
        key = str(sample.key_expr)
        if not self._deduplication.takes(number, key, sample) or self._aside:
            return
        quiet = self._barrier.holds(key, now, ordered=self._courses.of(key).covering is None)
        if quiet is None:
            self._take(now, key, sample)
        else:
            self._barrier.hold(key, now, size_of(sample), partial(self._take, None, key, sample), quiet=quiet)

    def _take(self, now: float | None, key: str, sample: zenoh.Sample) -> None:
        """Sort a sample that came now, or was held until now where `now` is None."""
        now = clock.monotonic() if now is None else now
        stamp = sample.timestamp
        origin = None if stamp is None else origin_of(stamp)
        if stamp is not None and origin == self._own and self._stamped.holds(key, stamp):
            self.returned += 1
            return
        course = self._courses.of(key)
        size = size_of(sample)
        reason = TOO_LARGE if size > self._largest else course.dropped
        if reason is not None:
            self._drop(reason)
            return
        source = sample.source_info if course.numbered else None
        stamp = stamp or self._mesh.new_timestamp()
        if origin is None or origin == self._own:
            self._stamped.note(key, stamp)
        held = Held(sample, stamp, key, size, source)
        self._demand.note(key, sample, covered=course.covering is not None)
        # Behind what waits for a decision: that had no turn yet when the mode became `pass`, or specs dropped the key.
        if course.passes is not None and (course.behind is None or not self._payloads.holds(key)):
            self._egress.pass_on(course.passes, held)
        elif course.behind is not None:
            self._hold(now, held, origin, course.behind, each=course.each)

    def _drop(self, reason: str) -> None:
        if reason == DENIED:
            self._rules.out.count("samples")
        self._passed.add(reason, 0)

    def _hold(self, now: float, held: Held, origin: str | None, covering: InformationType, *, each: bool) -> None:
        if self._room.crowded and held.waits and not self._egress.stands:
            self._room.linger(held.size)
        number = self._payloads.enter(held)
        if number is None:
            self._passed.add(OVERFLOW, 0)
            return
        sample = (self._payloads.waiting(number) or held).sample
        published = SamplePublished(
            now=now,
            sample=number,
            key=held.key,
            size=held.size,
            t_gen=generated(None if origin is None else held.stamp, now, clock.wall()),
            origin=origin,
            priority=priority_of(sample),
            features={},
            delete=sample.kind == zenoh.SampleKind.DELETE,
        )
        superseded = self._submit(published, covering, sample.payload, sample.attachment, each=each)
        if superseded is not None:
            self._payloads.drop(superseded)
