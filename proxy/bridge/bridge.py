"""Everything that crosses between the apps and the mesh, put together."""

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import partial
from typing import Any

from proxy import clock
from proxy.bridge.barrier import Barrier
from proxy.bridge.broadcast import Broadcast
from proxy.bridge.courses import Courses
from proxy.bridge.delivery import Delivery
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.fence import Fence
from proxy.bridge.gone_routers import GoneRouters
from proxy.bridge.half_open import HalfOpen
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.ingress import Ingress, Submit
from proxy.bridge.linger import Linger
from proxy.bridge.links import Links
from proxy.bridge.mirroring import Checked, Mirroring
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.passed import Passed
from proxy.bridge.payloads import Payloads
from proxy.bridge.queries import Queries
from proxy.bridge.room import rooms
from proxy.bridge.rules import Rules
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.sessions import largest_payload
from proxy.bridge.sides import Sides
from proxy.bridge.silence import Silence, longest_silence
from proxy.config import Config
from proxy.core.interface.events import CopyRefused, Event, SampleRefused
from proxy.runtime import LiveRuntime
from proxy.tuning import TUNING


@dataclass(frozen=True, slots=True)
class CoreLink:
    """How the core learns of covered samples, of what it must know, and of samples of others unless it is busy."""

    submit: Submit
    post: Callable[[Event], None]
    note: Callable[[Event], object]
    wanted: Callable[[Collection[str]], None]
    """Takes what nodes on the mesh have begun to want."""


class Bridge:
    """Carries samples between the app side and the air, queries and tokens between the mirror sessions of `sides`.

    What an information type covers waits among `payloads` until the core says what becomes of it; all else crosses by
    itself. In mode `enforce` what is forwarded is paced to the rate of the specs. `hold_back` puts what comes anew from
    robots that were lost after what they kept for us.
    """

    def __init__(
        self,
        config: Config,
        sides: Sides,
        live: LiveRuntime,
        *,
        neighbours: Neighbours,
        hold_back: HoldBack,
        core: CoreLink,
    ) -> None:
        self._live = live
        self._limit = live.runtime.specs, math.inf
        """Where limits have moved to [B/s], and the specs whose limits they are."""
        self._core = core
        self._rules = Rules(config.bridge)
        self.rooms = rooms(config.queue.samples, config.queue.bytes)
        self.payloads = Payloads(self.rooms.covered)
        self.executors = (SerialExecutor("queries out"), SerialExecutor("queries in"))
        self._holders = (SerialExecutor("samples out"), SerialExecutor("samples in"))
        sourced = sides.apps.keeps_source and sides.others.keeps_source
        self._courses = Courses(live, self._rules, sourced=sourced)
        self._passed = Passed()
        self.demand = _demand(config, sides, core)
        self._egress = Egress(sides.data, self.demand, self._passed, core.post, live.runtime.pace, rooms=self.rooms)
        self._broadcast = (sides.data,) if isinstance(sides.data, Broadcast) else ()
        fence = Fence(sides.wake.set)
        self._barriers = out, into = (
            Barrier(sides.apps, sides.others, fence, self._holders[0]),
            Barrier(sides.others, sides.apps, fence, self._holders[1]),
        )
        self._ingress = self._make_ingress(sides, out, largest_payload(config.mesh.zenoh))
        self._delivery = self._make_delivery(sides, hold_back, into, sourced=sourced)
        self._outward, self._inward = self._make_queries(sides, fence, sourced=sourced)
        self._links = Links(sides.mesh, config.mesh.connect, clock.monotonic())
        self._app_links = Links(sides.app, config.app.connect, clock.monotonic(), "app")
        self._half_open = HalfOpen(sides.mesh)
        links = (
            self._links,
            self._app_links,
            Linger(sides.app),
            Linger(sides.mesh),
            sides.rediscovery,
            Silence(sides.mesh, longest_silence(config.mesh.zenoh)),
            self._half_open,
            hold_back,
            GoneRouters(sides.app, sides.apps, lambda: self._ingress.declared),
        )
        self._mirroring = self._make_mirroring(sides, links, neighbours, fence)

    def _make_ingress(self, sides: Sides, barrier: Barrier, largest: int) -> Ingress:
        return Ingress(
            app=sides.app,
            mesh=sides.mesh,
            courses=self._courses,
            egress=self._egress,
            demand=self.demand,
            passed=self._passed,
            rules=self._rules,
            submit=self._core.submit,
            payloads=self.payloads,
            room=self.rooms.covered,
            largest=largest,
            barrier=barrier,
        )

    def _make_delivery(self, sides: Sides, hold_back: HoldBack, barrier: Barrier, *, sourced: bool) -> Delivery:
        delivery = Delivery(
            sides.app,
            sides.mesh,
            self._live.match,
            self._rules,
            self._core.note,
            numbered=sourced,
            counts_each=self._live.counts_each,
            hold_back=hold_back,
            barrier=barrier,
        )
        if isinstance(sides.data, Broadcast):
            sides.data.listen(delivery.overhear)
        return delivery

    def _make_queries(self, sides: Sides, fence: Fence, *, sourced: bool) -> tuple[Queries, Queries]:
        """Return those from apps to the mesh, and from the mesh to apps."""
        near, far, (out, into) = sides.apps, sides.others, self.executors
        make = partial(Queries, dropped=self._live.drops_queries)
        ahead, numbered = self._barriers, self._courses.numbered
        return (
            make(near, far.session, out, fence, self._rules.into, numbered=lambda _: sourced, ahead=ahead),
            make(far, near.session, into, fence, self._rules.out, numbered=numbered, ahead=(ahead[1], ahead[0])),
        )

    def _make_mirroring(
        self, sides: Sides, links: tuple[Checked, ...], neighbours: Neighbours, fence: Fence
    ) -> Mirroring:
        return Mirroring(
            sides,
            ingress=self._ingress,
            delivery=self._delivery,
            demand=self.demand,
            outward=self._outward,
            inward=self._inward,
            links=links,
            buffers=self._egress.buffers,
            rules=self._rules,
            neighbours=neighbours,
            passed=self._passed,
            post=self._core.post,
            wanted=self._core.wanted,
            live=self._live,
            fence=fence,
        )

    def open(self) -> None:
        """Let things cross."""
        self._egress.start()
        self._delivery.open()
        self._mirroring.start()

    def close(self) -> None:
        """Let nothing cross any more: subscriptions first, so that nothing comes in while the rest closes."""
        self._mirroring.close(TUNING.stop_wait)
        for barrier in self._barriers:
            barrier.close(TUNING.stop_wait)
        self._half_open.close()
        self._ingress.close()
        for part in (self._delivery, self._outward, self._inward):
            part.close()
        for thread in (*self._holders, self._egress, *self.executors):
            thread.close(TUNING.stop_wait)
        self.demand.close()

    def forward(self, number: int) -> None:
        """Send a covered sample to the mesh."""
        held = self.payloads.waiting(number)
        if held is None:
            self._core.post(SampleRefused(clock.monotonic(), number))
        else:
            self._egress.forward(number, held)
            self.payloads.release(number)  # only now, or one of its key that passes would overtake it

    def send_copy(self, number: int, to: str) -> None:
        """Send a sample that is kept to the robot with this tag alone."""
        held = self.payloads.copy(number, to)
        if held is None:
            self._core.post(CopyRefused(clock.monotonic(), number, to))
        else:
            self._egress.forward(number, held)

    def retain(self, expressions: tuple[str, ...]) -> None:
        """Take what apps publish on these key expressions, even if nobody who is here wants it."""
        self._mirroring.retain(expressions)

    def renew(self) -> None:
        """Take note that another runtime is in force: for samples that come from now on."""
        runtime = self._live.runtime
        specs, limit = self._limit
        pace = runtime.pace
        self._egress.pace(pace if pace is None or specs is not runtime.specs else min(pace, limit))

    def set_pace(self, rate: float) -> None:
        """Send what was decided no faster than `rate` [B/s], until specs are swapped: a limit has moved."""
        self._limit = self._live.runtime.specs, rate
        self.renew()

    def flush(self) -> None:
        """Report what passed without a decision up to now."""
        self._mirroring.flush()

    def describe(self) -> dict[str, Any]:
        """Return what the status says of the bridge."""
        return {
            "denied": self._rules.describe(),
            "surplus": {"out": dict(self._rules.out.surplus), "in": dict(self._rules.into.surplus)},
            "links": self._links.describe(),
            "held": len(self.payloads),
            "returned": self._ingress.returned,
            "egress": self._egress.waiting | {"risked": self._egress.writer.risked},
            "queue": self.rooms.describe(),
            "delivered": self._delivery.delivered,
            "repeated": self._delivery.repeated,
            "held_back": self._delivery.hold_back.held,
            "subscriptions": list(self._delivery.expressions),
            "observed": sorted(self._ingress.declared),
            "wanted": self.demand.wanted,
            "queries": {"outward": self._outward.crossed, "inward": self._inward.crossed},
            "queryables": {
                "outward": list(self._outward.expressions),
                "inward": list(self._inward.expressions),
            },
        }

    def warnings(self) -> list[str]:
        """Name what is dialled and not linked, and what is declared and not mirrored."""
        found = (self._links, self._app_links, self._rules, self._mirroring, *self._broadcast)
        return [warning for each in found for warning in each.warnings()]


def _demand(config: Config, sides: Sides, core: CoreLink) -> Demand:
    return Demand(
        sides.mesh,
        core.post,
        sides.wake.set,
        broadcast=sides.data is not sides.mesh,
        relayed=config.mesh.relayed,
    )
