"""Routers that were linked to the app side and went: what was behind them is looked for once more.

A wider declaration hides what is gone, as whoever publishes has somebody who subscribes all the same. So it is looked
for again when declarations have changed.
"""

import math
from collections.abc import Callable, Collection

import zenoh

from proxy.bridge.declarations.declarations import Declarations
from proxy.bridge.tuning import TUNING


class GoneRouters:
    """Follows the routers that `session` is linked to; `own` gives what it subscribes to itself."""

    def __init__(self, session: zenoh.Session, declarations: Declarations, own: Callable[[], Collection[str]]) -> None:
        self._declarations, self._own = declarations, own
        self._gone, self._due = False, math.inf
        self._edition, self._again_at = declarations.edition, math.inf
        """What was declared at the last look, and when there may be another one, if that has changed [s]."""
        events = session.info.declare_transport_events_listener
        self._listener = events(zenoh.handlers.Callback(self._hear, indirect=False))

    def check(self, now: float) -> float | None:
        """Look for what is left when a router has gone and the session has taken note of it."""
        if self._gone:
            self._gone, self._due = False, now + TUNING.router_forgotten
        if now >= self._again_at and self._declarations.edition != self._edition:
            self._due = now
        if now < self._due:
            return self._due if self._due < math.inf else None
        self._declarations.forget_gone(self._own())
        self._due, self._again_at = math.inf, now + TUNING.gone_looked_for
        self._edition = self._declarations.edition
        return None

    def _hear(self, event: zenoh.TransportEvent) -> None:
        if event.kind == zenoh.SampleKind.DELETE and event.transport.whatami == zenoh.WhatAmI.ROUTER:
            self._gone = True
