"""Mirrors what both sides declare, as soon as it changes."""

import logging
import threading
from collections.abc import Callable

import zenoh

from proxy import clock
from proxy.bridge.declaration import Declaration
from proxy.bridge.delivery import Delivery
from proxy.bridge.demand import Demand
from proxy.bridge.ingress import Ingress
from proxy.bridge.keys import CROSSING
from proxy.bridge.links import Links
from proxy.bridge.mirror import Mirror
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.passed import Passed
from proxy.bridge.queries import Queries
from proxy.bridge.voice import Voice
from proxy.core.events import Event, InterestChanged

log = logging.getLogger(__name__)

INTERVAL = 0.1
"""Time between two looks when nothing is said to have changed [s]."""

ECHO = 0.25
"""How long after its end a token of ours may still be echoed [s]."""


class Watch:
    """Follows two voices on a thread of its own.

    `outward` and `inward` are queries from apps to mesh and from mesh to apps. `wake` is set when there is news.
    """

    def __init__(
        self,
        *,
        apps: Voice,
        others: Voice,
        delivery: Delivery,
        demand: Demand,
        outward: Queries,
        inward: Queries,
        links: tuple[Links, ...],
        ingress: Ingress,
        neighbours: Neighbours,
        passed: Passed,
        post: Callable[[Event], None],
        wake: threading.Event,
    ) -> None:
        self._apps = apps
        self._others = others
        self._delivery = delivery
        self._demand = demand
        self._outward = outward
        self._inward = inward
        self._links = links
        self._ingress = ingress
        self._neighbours = neighbours
        self._passed = passed
        self._post = post
        self._wake = wake
        self._tokens_out = Mirror(_token(others.session))
        self._tokens_in = Mirror(_token(apps.session))
        self._echoes_out = _Echoes(self._tokens_out)
        self._echoes_in = _Echoes(self._tokens_in)
        self._stop = False
        self._thread = threading.Thread(target=self._run, name="watch", daemon=True)

    def start(self) -> None:
        """Start looking."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop looking; wait at most `timeout` [s] for the look in hand. Takes the tokens back."""
        self._stop = True
        self._wake.set()
        self._thread.join(timeout)
        self._tokens_out.close()
        self._tokens_in.close()

    def flush(self) -> None:
        """Report what passed without a decision since the last time."""
        for event in self._passed.take(clock.monotonic()):
            self._post(event)

    def _run(self) -> None:
        while not self._stop:
            self._wake.clear()
            try:
                self._look()
            except Exception:
                # A look that fails must not be the last one.
                log.exception("cannot mirror what was declared")
            self._wake.wait(INTERVAL)

    def _look(self) -> None:
        self.flush()
        self._ingress.aside = aside = self._neighbours.aside
        if aside:
            self._mirror_nothing()
        else:
            self._mirror()
        self._demand.update()
        for links in self._links:
            links.check(clock.monotonic())

    def _mirror(self) -> None:
        # Tokens are read first and mirrored last: whoever sees one finds what was declared before it.
        alive_in, alive_out = self._others.declared("token"), self._apps.declared("token")
        wanted = self._apps.declared("subscriber")
        if self._apps.ledger.broken:
            wanted |= dict.fromkeys(CROSSING, False)
        self._deliver(wanted)
        self._inward.update(self._apps.declared("queryable"))
        self._outward.update(self._others.declared("queryable"))
        self._tokens_out.update(self._echoes_in.without(alive_out) if self._apps.echoes else alive_out)
        self._tokens_in.update(self._echoes_out.without(alive_in) if self._others.echoes else alive_in)

    def _mirror_nothing(self) -> None:
        self._deliver({})
        for mirror in (self._inward, self._outward, self._tokens_out, self._tokens_in):
            mirror.update({})

    def _deliver(self, wanted: dict[str, bool]) -> None:
        if self._delivery.update(wanted):
            self._post(InterestChanged(clock.monotonic(), self._delivery.expressions))


class _Echoes:
    """Our own tokens on one side, which Zenoh echoes to a client, and for a moment after their end."""

    def __init__(self, mirror: Mirror) -> None:
        self._mirror = mirror
        self._own: dict[str, float] = {}

    def without(self, alive: dict[str, bool]) -> dict[str, bool]:
        """Leave them out of what is alive on that side."""
        now = clock.monotonic()
        self._own |= dict.fromkeys(self._mirror.expressions, now + ECHO)
        self._own = {token: until for token, until in self._own.items() if until > now}
        return {token: False for token in alive if token not in self._own}


def _token(session: zenoh.Session) -> Callable[[str, bool], Declaration]:
    return lambda expression, _complete: session.liveliness().declare_token(expression)
