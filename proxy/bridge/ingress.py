"""Receives the samples of apps that somebody on the mesh wants, stamps them and passes them on or holds them.

Never decides, and never waits for a mesh that stands still.
"""

import itertools
import logging
from collections.abc import Callable, Collection, Iterable
from functools import partial
from typing import NamedTuple, Protocol

import zenoh

from proxy import clock
from proxy.bridge.attached import attach
from proxy.bridge.cover import Cover
from proxy.bridge.declaration import Declaration
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.mirror import GRACE, Mirror
from proxy.bridge.overlap import Overlap, of_sample
from proxy.bridge.passed import BYPASS, DENIED, HEARTBEAT, MODE, NO_SPEC, OVERFLOW, Passed
from proxy.bridge.room import Room
from proxy.bridge.rules import ADVANCED, Rules, Verdict
from proxy.bridge.sample import Held, generated, origin_of, priority_of
from proxy.core.interface.events import SamplePublished
from proxy.core.model.mode import Mode, in_force
from utility_specs import InformationType

log = logging.getLogger(__name__)


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


COURSES_KEPT = 8192
"""Keys of which it is remembered what becomes of their samples."""


class _Course(NamedTuple):
    """What becomes of the samples of a key, as long as specs and mode stay as they are."""

    dropped: str | None
    """Why they do not cross."""
    passes: str | None
    """Why they need no decision."""
    covering: InformationType | None
    numbered: bool
    """Whether they keep the numbers of their publishers."""


class Ingress:
    """Subscribes on the app side to what the mesh wants and sorts it: the core gets what is covered, the rest passes.

    Covered samples are held until `release` or `drop`, as far as there is `room`. `submit` gets them for the core, with
    the type that covers them. Without `sourced` no sample keeps the number of its publisher.
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
        rules: Rules,
        submit: Submit,
        mode: Mode,
        sourced: bool,
        room: Room,
    ) -> None:
        self._mode = mode
        self._aside = False
        """Whether another daemon takes care of our apps: then everything is left to it."""
        self._app = app
        self._mesh = mesh
        self._match = match
        self._egress = egress
        self._demand = demand
        self._passed = passed
        self._rules = rules
        self._submit = submit
        self._sourced = sourced
        self._room = room
        self._courses: dict[str, _Course] = {}
        self._numbers = itertools.count(1)
        self._held: dict[int, Held] = {}
        self._cover = Cover()
        self._overlap = Overlap(of_sample)
        self._mirror = Mirror(self._subscribe, GRACE)
        self._own = str(mesh.zid())
        self.returned = 0
        """Samples that left here for the mesh and came back around the daemons."""

    @property
    def mode(self) -> Mode:
        """The mode of the daemon."""
        return self._mode

    @mode.setter
    def mode(self, mode: Mode) -> None:
        self._mode = mode
        self.renew()

    def renew(self) -> None:
        """Work out anew what becomes of samples: specs or mode have changed."""
        self._courses = {}  # another one: callbacks that still fill the old one cannot spoil it

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

    def numbered(self, key: str) -> bool:
        """Whether samples of `key` keep the numbers of their publishers.

        Not where some may be dropped on purpose: subscribers would fetch those.
        """
        if self._rules.outward(key) is not Verdict.ORDINARY:
            return self._sourced
        return self._sourced and self._keeps_numbers(self._match(key))

    def release(self, number: int) -> Held | None:
        """Give out a held sample, which keeps its place; None when it is not held (any more)."""
        return self._held.pop(number, None)

    def drop(self, number: int) -> None:
        """Forget a held sample, if it is held."""
        if (held := self.release(number)) is not None:
            self._room.leave(held.size)

    def waiting(self, number: int) -> Held | None:
        """Return a held sample, which stays held; None when it is not held (any more)."""
        return self._held.get(number)

    @property
    def held(self) -> int:
        """Samples that wait for the core's answer."""
        return len(self._held)

    def _subscribe(self, expression: str, _complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        subscribe = partial(self._app.declare_subscriber, expression, allowed_origin=zenoh.Locality.REMOTE)
        return self._overlap.declare(expression, self._receive, subscribe)

    def _receive(self, number: int, sample: zenoh.Sample) -> None:
        attach()
        now = clock.monotonic()
        key = str(sample.key_expr)
        if not self._overlap.takes(number, key, sample) or self._aside:
            return
        stamp = sample.timestamp
        if stamp is not None and origin_of(stamp) == self._own:
            self.returned += 1
            return
        dropped, passes, covering, numbered = self._courses.get(key) or self._course(key)
        if dropped is not None:
            self._drop(dropped)
            return
        source = sample.source_info if numbered else None
        held = Held(sample, stamp or self._mesh.new_timestamp(), key, len(sample.payload), source)
        self._demand.note(key, sample, covered=covering is not None)
        if passes is not None:
            self._egress.pass_on(passes, held)
        elif covering is not None:
            self._hold(now, held, stamp, covering)

    def _course(self, key: str) -> _Course:
        courses = self._courses
        if len(courses) >= COURSES_KEPT:
            courses.clear()
        course = courses[key] = self._laid(key)
        return course

    def _laid(self, key: str) -> _Course:
        verdict = self._rules.outward(key)
        dropped = DENIED if verdict is Verdict.DENIED else None
        if verdict is Verdict.COMPANION and not self.numbered(key.partition(ADVANCED)[0]):
            dropped = HEARTBEAT
        covering = self._match(key) if verdict is Verdict.ORDINARY else None
        if covering is not None and covering.bypass:
            covering, verdict = None, Verdict.BYPASS
        passes = None
        if covering is None:
            passes = BYPASS if verdict is Verdict.BYPASS else NO_SPEC
        elif in_force(self._mode, covering.mode) is Mode.PASS:
            passes = MODE
        return _Course(dropped, passes, covering, self._sourced and self._keeps_numbers(covering))

    def _drop(self, reason: str) -> None:
        if reason == DENIED:
            self._rules.out.count("samples")
        self._passed.add(reason, 0)

    def _hold(self, now: float, held: Held, stamp: zenoh.Timestamp | None, covering: InformationType) -> None:
        if self._room.crowded and held.waits and not self._egress.stands:
            self._room.linger(held.size)
        if not self._room.enter(held.size):
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
        payload, attachment = held.sample.payload, held.sample.attachment
        each = in_force(self.mode, covering.mode) is Mode.SHADOW
        superseded = self._submit(published, covering, payload, attachment, each=each)
        if superseded is not None:
            self.drop(superseded)

    def _keeps_numbers(self, covering: InformationType | None) -> bool:
        """Whether none of the samples that a type covers is dropped on purpose."""
        return covering is None or covering.bypass or in_force(self.mode, covering.mode) is not Mode.ENFORCE
