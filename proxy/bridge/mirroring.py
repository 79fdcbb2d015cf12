"""Mirrors what both sides declare, as soon as it changes, and looks only at what has."""

import logging
import math
import threading
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Protocol

import zenoh

from proxy import clock
from proxy.bridge.declaration import Declaration
from proxy.bridge.delivery import Delivery
from proxy.bridge.demand import Demand
from proxy.bridge.fence import Fence
from proxy.bridge.ingress import Ingress
from proxy.bridge.keys import INGRESS
from proxy.bridge.mirror import Mirror
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.passed import Passed
from proxy.bridge.queries import Queries
from proxy.bridge.rules import Direction, Rules
from proxy.bridge.send_buffers import SendBuffers
from proxy.bridge.sides import Sides
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import Event, InterestChanged, LinksGauged
from proxy.runtime import LiveRuntime

log = logging.getLogger(__name__)


_NOTHING: Mapping[str, bool] = {}


class Checked(Protocol):
    """Something that looks at links, or at what waits for them, now and then."""

    def check(self, now: float) -> float | None:
        """Look; return when at the latest to look again [s], if it matters."""


class Mirroring:
    """Follows what nodes of both `sides` declare, on a thread of its own.

    The main sessions of these sides declare what `ingress` and `delivery` subscribe to;
    `outward` and `inward` are queries from apps to mesh and from mesh to apps.
    """

    def __init__(
        self,
        sides: Sides,
        *,
        ingress: Ingress,
        delivery: Delivery,
        demand: Demand,
        outward: Queries,
        inward: Queries,
        links: tuple[Checked, ...],
        buffers: SendBuffers,
        rules: Rules,
        neighbours: Neighbours,
        passed: Passed,
        post: Callable[[Event], None],
        wanted: Callable[[Collection[str]], None],
        live: LiveRuntime,
        fence: Fence,
    ) -> None:
        self._apps = apps = sides.apps
        self._others = others = sides.others
        self._ingress = ingress
        self._delivery = delivery
        self._demand = demand
        self._outward = outward
        self._inward = inward
        self._links = links
        self._buffers = buffers
        self._rules = rules
        self._neighbours = neighbours
        self._passed = passed
        self._post, self._wanted = post, wanted
        self._live = live
        self._wake = sides.wake
        self._fence = fence
        self._tokens_out = Mirror(_token(others.session))
        self._tokens_in = Mirror(_token(apps.session))
        self._ended_out, self._ended_in = set[str](), set[str]()
        """Tokens that ended since theirs were mirrored."""
        self._brief_out, self._brief_in = set[str](), set[str]()
        """Those that had ended before they were mirrored, at the last look."""
        self._seen: dict[str, Mapping[str, bool]] = {}
        self._editions = (0, 0)
        self._stirred = True
        self._retained: Mapping[str, bool] = {}
        self._retained_now: Mapping[str, bool] = self._retained
        self._stop = False
        self._thread = threading.Thread(target=self._run, name="watch", daemon=True)

    def start(self) -> None:
        """Start looking."""
        self._wake.set()
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop looking; wait at most `timeout` [s] for the look in hand. Takes the tokens back."""
        self._stop = True
        self._wake.set()
        self._thread.join(timeout)
        self._tokens_out.close()
        self._tokens_in.close()

    def retain(self, expressions: Iterable[str]) -> None:
        """Take what apps publish on these even if nobody on the mesh wants it. From any thread."""
        self._retained = dict.fromkeys(expressions, False)
        self._wake.set()

    def warnings(self) -> list[str]:
        """Say which declarations cannot be followed."""
        return [*self._apps.warnings(), *self._others.warnings()]

    def flush(self) -> bool:
        """Report what passed without a decision since the last time; whether anything did."""
        passed = self._passed.take(clock.monotonic())
        for event in passed:
            self._post(event)
        return bool(passed)

    def _run(self) -> None:
        again, busy, complaint, links_at = False, False, "", -math.inf
        while not self._stop:
            pause = TUNING.mirroring_interval if again or busy else links_at - clock.monotonic()
            woken = self._wake.wait(max(pause, 0.0))
            if woken:  # else what came just after the wait would be forgotten
                self._wake.clear()
            try:
                self._buffers.refresh()
                if (now := clock.monotonic()) >= links_at:
                    links_at = now + TUNING.link_check
                    asked = [links.check(now) for links in self._links]
                    links_at = min([links_at, *(at for at in asked if at is not None)])
                passed, gauged = self.flush(), self._gauge()
                busy = passed or gauged
                if woken or again:
                    began = clock.monotonic()
                    again = self._look()
                    self._rest(clock.monotonic() - began)
            except Exception as error:
                # A look that fails must not be the last one; between two that do one may find nothing to declare.
                self._seen.clear()
                self._stirred = again = True
                if str(error) != complaint:
                    log.exception("cannot mirror what was declared")
                complaint = str(error)
                self._fence.end()

    def _rest(self, took: float) -> None:
        """Who declares without end must not take the processor from what crosses."""
        if took > TUNING.long_look:
            time.sleep(min(TUNING.longest_rest, TUNING.rest_after_look * took))

    def _gauge(self) -> bool:
        """Tell the core how long what the links send is on its way; whether a limit follows that."""
        adaptive = self._live.runtime.adaptive
        if adaptive and (waits := self._buffers.waits()):
            self._post(LinksGauged(clock.monotonic(), waits))
        return adaptive

    def _look(self) -> bool:
        """Mirror what has changed; return whether to look again although nothing changes."""
        awaited = self._fence.begin()
        editions = self._apps.edition, self._others.edition
        aside = self._neighbours.aside
        turned = self._ingress.stand_aside(aside)
        retained, self._retained_now = self._retained_now, self._retained
        turned = turned or retained is not self._retained_now
        # What turns a witness tells a moment later; who waits must not pass before.
        heard = [side.ask_witnesses() for side in (self._apps, self._others)] if awaited else []
        if turned or any(heard) or editions != self._editions or self._unsettled():
            if aside:
                self._mirror_nothing()
            else:
                self._mirror()
            self._editions = editions
        self._fence.end()
        self._demand.update()
        return self._unsettled()

    def _unsettled(self) -> bool:
        """Whether what we declare or took back ourselves is not told yet, or waits, or what others want has turned."""
        waiting = self._apps.unsettled(self._tokens_in.declared) or self._others.unsettled(self._tokens_out.declared)
        return waiting or self._stirred or self._ingress.leaving or self._delivery.leaving

    def _mirror(self) -> None:
        now = clock.monotonic()
        # Tokens are read first and mirrored last: whoever sees one finds what was declared before it.
        ours_out, ours_in = {*self._tokens_out.declared, *self._brief_out}, {*self._tokens_in.declared, *self._brief_in}
        self._ended_in |= self._others.ended_tokens(ours_out)
        self._ended_out |= self._apps.ended_tokens(ours_in)
        alive_in = self._others.foreign_tokens(ours_out, now, kept=self._tokens_in.declared)
        alive_out = self._apps.foreign_tokens(ours_in, now)
        answered_in, answered_out = self._others.declared("queryable"), self._apps.declared("queryable")
        self._subscribe(now)
        if self._news("queryables out", answered_out):
            self._inward.update(self._rules.out.crossing("queryables", answered_out))
        if self._news("queryables in", answered_in):
            self._outward.update(self._rules.into.crossing("queryables", answered_in))
        self._brief_out = self._show("tokens out", self._tokens_out, self._rules.out, alive_out, self._ended_out)
        self._brief_in = self._show("tokens in", self._tokens_in, self._rules.into, alive_in, self._ended_in)

    def _show(
        self, name: str, mirror: Mirror, direction: Direction, alive: Mapping[str, bool], ended: set[str]
    ) -> set[str]:
        """Mirror the tokens that are `alive` now, and those that have `ended`.

        Return those that came and went between two looks: so they do on the other side.
        """
        before = self._seen.get(name, _NOTHING)
        if not self._news(name, alive) and not ended:
            return set()
        unseen = ended.difference(before, alive, mirror.declared)
        mirror.update(self._rules.tokens(direction, alive), ended)
        brief = set(self._rules.passing(direction, unseen))
        for token in brief:
            mirror.show(token)
        ended.clear()
        return brief

    def _news(self, name: str, told: Mapping[str, bool]) -> bool:
        """Whether something else of `name` is declared than at the last look."""
        before = self._seen.get(name, _NOTHING)
        self._seen[name] = told
        return told is not before

    def _subscribe(self, now: float) -> None:
        wanted = self._apps.foreign_subscribers(self._ingress.declared, now)
        asked = self._deliver(self._rules.into.crossing("subscribers", wanted))
        wanted = self._others.foreign_subscribers(self._delivery.declared, now)
        observed = {*self._rules.out.crossing("subscribers", {**wanted, **self._retained_now})}
        # Who subscribes without end keeps nobody from what applications publish: then all of it is taken in.
        taken = self._ingress.update(observed.union(INGRESS) if self._rules.out.surplus["subscribers"] else observed)
        # What we subscribe to ourselves from now on needs its witnesses: at once, for it may be told already.
        self._stirred = asked or taken
        if taken:
            self._wanted(self._ingress.declared)
        if self._stirred:
            self._wake.set()

    def _mirror_nothing(self) -> None:
        self._deliver({})
        self._ingress.update(())
        self._stirred = False
        for side in (self._apps, self._others):
            side.ended_tokens(())  # mirrored nowhere
        for mirror in (self._inward, self._outward, self._tokens_out, self._tokens_in):
            mirror.update({})
        self._seen.clear()

    def _deliver(self, wanted: Mapping[str, bool]) -> bool:
        news = self._delivery.update(wanted)
        if news:
            self._post(InterestChanged(clock.monotonic(), self._delivery.expressions))
        return news


def _token(session: zenoh.Session) -> Callable[[str, bool], Declaration]:
    return lambda expression, _complete: session.liveliness().declare_token(expression)
