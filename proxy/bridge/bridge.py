"""Everything that crosses between the apps and the mesh, put together."""

import math
import threading
from collections.abc import Callable
from typing import Any

import zenoh

from proxy import clock
from proxy.bridge.air import Air, Broadcast
from proxy.bridge.declarations.declarations import Declarations
from proxy.bridge.delivery import Delivery
from proxy.bridge.demand import Demand
from proxy.bridge.egress import Egress
from proxy.bridge.fence import Fence
from proxy.bridge.half_open import HalfOpen
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.ingress import Ingress, Submit
from proxy.bridge.lane import Lane
from proxy.bridge.links import Links
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.passed import Passed
from proxy.bridge.queries import Queries
from proxy.bridge.recall import Recall
from proxy.bridge.room import Rooms
from proxy.bridge.rules import Rules
from proxy.bridge.sample import Held
from proxy.bridge.silence import SILENT, Silence
from proxy.bridge.watch import Watch
from proxy.core.interface.events import CopyRefused, Event, SampleRefused
from proxy.core.model.mode import Mode
from utility_specs import InformationType, Specs

_PATIENCE = 0.15
"""How long closing waits for a thread that is inside a call of Zenoh [s]."""


class Bridge:
    """Carries samples between the session `app` and the `air`, queries and tokens between their mirror sessions.

    In unicast the air is the session `mesh`.

    What an information type covers goes to `submit` and waits until `forward` or `drop`; all else crosses by itself.
    `post` gets what the core must know, `offer` what arrived, as far as it keeps up. In mode `enforce` forwarded samples
    are paced to the specs' rate. `apps` and `others` must have been opened with `wake.set` as what to call when
    something changed. Links to robots that are silent for `silent` [s] are ended. `hold_back` puts what comes anew from
    robots that were lost after what they kept for us.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        mesh: zenoh.Session,
        air: Air,
        apps: Declarations,
        others: Declarations,
        neighbours: Neighbours,
        wake: threading.Event,
        specs: Specs,
        mode: Mode,
        connect: tuple[str, ...],
        rules: Rules,
        app_connect: tuple[str, ...],
        relayed: bool,
        rooms: Rooms,
        recall: Recall,
        hold_back: HoldBack,
        silent: float = SILENT,
        submit: Submit,
        post: Callable[[Event], None],
        offer: Callable[[Event], object],
    ) -> None:
        self._specs = specs
        self._most = math.inf
        self._post = post
        self._rules = rules
        self._rooms = rooms
        self._kept: dict[int, Held] = {}
        """Samples that may be sent to a robot that is away or was; the core bounds them."""
        self.demand = Demand(mesh, post, wake.set, broadcast=air is not mesh, relayed=relayed)
        passed = Passed()
        sourced = apps.keeps_source and others.keeps_source
        self._egress = Egress(air, self.demand, passed, post, _pace(specs, mode), rooms=rooms)
        self._ingress = Ingress(
            app=app,
            mesh=mesh,
            match=self._match,
            egress=self._egress,
            demand=self.demand,
            passed=passed,
            rules=rules,
            submit=submit,
            mode=mode,
            sourced=sourced,
            room=rooms.covered,
        )
        self._delivery = Delivery(
            app,
            mesh,
            self._match,
            rules,
            offer,
            numbered=sourced,
            counts_each=self._counts_each,
            hold_back=hold_back,
        )
        if isinstance(air, Broadcast):
            air.listen(self._delivery.overhear)
        self.lanes = (Lane("queries out"), Lane("queries in"))
        fence = Fence(wake.set)
        near, far = (apps, others.session, self.lanes[0]), (others, apps.session, self.lanes[1])
        self._outward = Queries(*near, fence, rules.into, dropped=self._dropped, numbered=lambda _: sourced)
        self._inward = Queries(*far, fence, rules.out, dropped=self._dropped, numbered=self._ingress.numbered)
        self._links = Links(mesh, connect, clock.monotonic())
        routers = Links(app, app_connect, clock.monotonic(), "app")
        self._half_open = HalfOpen(mesh)
        self._watch = Watch(
            apps=apps,
            others=others,
            ingress=self._ingress,
            delivery=self._delivery,
            demand=self.demand,
            outward=self._outward,
            inward=self._inward,
            links=(self._links, routers, recall, Silence(mesh, silent), self._half_open, hold_back),
            headroom=self._egress.headroom,
            rules=rules,
            neighbours=neighbours,
            passed=passed,
            post=post,
            wake=wake,
            fence=fence,
        )
        self._watch.gauging = _adaptive(specs)

    def open(self) -> None:
        """Let things cross."""
        self._egress.start()
        self._delivery.open()
        self._watch.start()

    def close(self) -> None:
        """Let nothing cross any more: subscriptions first, so that nothing comes in while the rest closes."""
        self._watch.close(_PATIENCE)
        self._half_open.close()
        self._ingress.close()
        for part in (self._delivery, self._outward, self._inward):
            part.close()
        for thread in (self._egress, *self.lanes):
            thread.close(_PATIENCE)
        self.demand.close()

    def forward(self, number: int) -> None:
        """Send a covered sample to the mesh."""
        held = self._ingress.release(number)
        if held is None:
            self._post(SampleRefused(clock.monotonic(), number))
        else:
            self._egress.forward(number, held)

    def drop(self, number: int) -> None:
        """Forget a covered sample."""
        self._ingress.drop(number)

    def keep(self, number: int) -> None:
        """Keep a covered sample besides, whatever becomes of it, until `forget`."""
        if (held := self._ingress.waiting(number)) is not None:
            self._kept[number] = held

    def forget(self, number: int) -> None:
        """Keep a sample no longer."""
        self._kept.pop(number, None)

    def send_copy(self, number: int, to: str) -> None:
        """Send a sample that is kept to the robot with this tag alone."""
        held = self._kept.get(number)
        if held is None:
            self._post(CopyRefused(clock.monotonic(), number, to))
        else:
            self._egress.forward(number, held._replace(to=to))

    def retain(self, expressions: tuple[str, ...]) -> None:
        """Take what apps publish on these key expressions, even if nobody who is here wants it."""
        self._watch.retain(expressions)

    def held(self, number: int) -> Held | None:
        """Return a covered sample that waits for its decision; None when it does not (any more)."""
        return self._ingress.waiting(number)

    def switch(self, mode: Mode) -> None:
        """Change the mode for samples that come from now on."""
        self._ingress.mode = mode
        self._pace_egress()

    def swap(self, specs: Specs) -> None:
        """Put another generation of specs in force for samples that come from now on."""
        self._specs = specs
        self._ingress.renew()
        self._watch.gauging = _adaptive(specs)
        self._most = math.inf
        self._pace_egress()

    def set_pace(self, rate: float) -> None:
        """Send what was decided no faster than `rate` [B/s], until specs are swapped: a limit has moved."""
        self._most = rate
        self._pace_egress()

    def _pace_egress(self) -> None:
        rate = _pace(self._specs, self._ingress.mode)
        self._egress.pace(None if rate is None else min(rate, self._most))

    def flush(self) -> None:
        """Report what passed without a decision up to now."""
        self._watch.flush()

    def describe(self) -> dict[str, Any]:
        """Return what the status says of the bridge."""
        return {
            "denied": self._rules.describe(),
            "surplus": {"out": dict(self._rules.out.surplus), "in": dict(self._rules.into.surplus)},
            "links": self._links.describe(),
            "held": self._ingress.held,
            "returned": self._ingress.returned,
            "egress": self._egress.waiting | {"risked": self._egress.risked},
            "queue": self._rooms.describe(),
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
        """Name what is declared and not mirrored."""
        return self._rules.warnings()

    def _match(self, key: str) -> InformationType | None:
        return self._specs.match(key)

    def _counts_each(self, key: str) -> bool:
        covering = self._match(key)
        return covering is not None and not covering.markovian

    def _dropped(self, key: str) -> bool:
        """Whether a spec drops the queries for a key."""
        covering = self._match(key)
        return covering is not None and covering.queries == "drop"


def _pace(specs: Specs, mode: Mode) -> float | None:
    """Return the rate of the tightest limit of the channel [B/s]; None: as fast as it goes, as some of it must."""
    rate = min((constraint.measure.pace for constraint in specs.constraints), default=math.inf)
    return rate if mode is Mode.ENFORCE and "shadow" not in specs.modes and math.isfinite(rate) else None


def _adaptive(specs: Specs) -> bool:
    """Whether any limit follows the channel."""
    return any(constraint.least < 1.0 for constraint in specs.constraints)
