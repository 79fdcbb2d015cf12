"""Queries change nothing: who looks at a core, and when, makes no difference to what it does."""

from collections import deque
from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import Plan
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from tests.fuzz.target import specs
from utility_specs import InformationType, Specs

SPECS = specs()
KEYS = ("robot/r1/camera", "robot/r2/camera", "robot/x/camera", "other")
PEERS = {"aaaaaaaa01": "op", "eeeeeeee01": "r2"}
KEPT = {
    *("Stream._expected", "Stream._reach", "Interest._wanting"),
    *("Contention._" + kept for kept in ("revision", "revisions", "rows", "robots", "known")),
    *(
        "Budget._others_known",
        "Budget._others_sent",
        "Budget._usable",
        "Budget._usable_for",
        "Budget._others",
        "Stretch._others",
        "Openings._of",
        "Openings._known",
    ),
    *("LatencyFit._stale", "LatencyFit._line", "LatencyFit._classes"),
}
"""What is worked out once and kept until something else is noted, so that nobody can tell when it was."""

PUBLISH = st.tuples(st.just("publish"), st.sampled_from(KEYS), st.integers(100, 9000))
HEAR = st.tuples(st.just("hear"), st.sampled_from(KEYS), st.sampled_from((*PEERS, "feed")))
SPEAK = st.tuples(st.just("speak"), st.sampled_from(tuple(PEERS)), st.integers(0, 5))
MEET = st.tuples(st.just("meet"), st.sampled_from(tuple(PEERS)), st.just(0))
PART = st.tuples(st.just("part"), st.sampled_from(tuple(PEERS)), st.just(0))
DECIDE = st.tuples(st.just("decide"), st.booleans(), st.just(0))
MODE = st.tuples(st.just("mode"), st.sampled_from(Mode), st.just(0))
SWAP = st.tuples(st.just("swap"), st.just(""), st.just(0))
WAIT = st.tuples(st.just("wait"), st.sampled_from((0.01, 0.1, 0.5, 3.0, 70.0)), st.just(0))
ACTS = st.one_of(PUBLISH, PUBLISH, HEAR, SPEAK, SPEAK, MEET, MEET, PART, DECIDE, DECIDE, MODE, SWAP, WAIT, WAIT)


class Driven:
    """A core that is driven by acts; `said` is all that it commanded."""

    def __init__(self, coordination):
        self.core = Core(CoreSettings("r1", "0000000001", coordination=coordination, settle=0.3), SPECS, 0.0)
        self.now, self.samples, self.told, self.said, self.asked = 0.0, 0, 0, [], []

    def act(self, kind, what, count):
        """Do one of `ACTS`, a little later than the one before."""
        self.now += 0.02
        match kind:
            case "publish":
                self.samples += 1
                self.feed(ev.SamplePublished(self.now, self.samples, what, count, self.now, None, 5, {"red": 0.2}))
            case "hear":
                self.feed(ev.SampleHeard(self.now, what, 500, count, self.now, None))
            case "speak":
                self.speak(what, count)
            case "meet":
                self.feed(ev.PeerAppeared(self.now, PEERS[what], what))
                streams = (StreamState(1, f"robot/{PEERS[what]}/camera", "camera", 0.1),)
                self.feed(ev.StateHeard(self.now, State(PEERS[what], what, "enforce", "", streams, ("robot/**",))))
            case "part":
                self.feed(ev.PeerGone(self.now, PEERS[what], what))
            case "decide" if self.asked:
                ticket, problem = self.asked.pop()
                self.feed(ev.DecisionReady(self.now, ticket, Plan(what, (problem.current,) * what, 1.0, None, 1, 1)))
            case "mode":
                self.feed(ev.ModeChanged(self.now, what))
            case "swap":
                self.feed(ev.SpecsChanged(self.now, SPECS))
            case "wait":
                self.now += what
                self.feed(ev.TimePassed(self.now))

    def speak(self, zid, count):
        """A robot tells of its stream, and that it has heard us."""
        self.told += count
        news = (StreamDigest(1, self.told, self.told, self.now, self.now, 900, 1.0),) if self.told else ()
        echoes = (Echo("00000000", self.now - 0.02, self.now - 0.01, 0, 0.01, 1e-6),)
        digest = Digest(PEERS[zid], zid[:8], self.now, self.told, 900 * self.told, news, echoes)
        self.feed(ev.DigestHeard(self.now, digest))

    def feed(self, event):
        for command in self.core.handle(event):
            self.said.append(command)
            if isinstance(command, Decide):
                self.asked.append((command.ticket, command.problem))
            if isinstance(command, Forward):
                self.feed(ev.SampleHanded(self.now, command.sample))


def queries(core, now):
    """Ask all that can be asked of a core and its parts: a name and a function each."""
    view, budget, gate, capacity, gossip = core.view, core.budget, core.gate, core.channel.capacity, core.gossip
    limits = range(len(budget.limits))
    use = tuple(0.1 * limit.limit for limit in budget.limits)
    yield "core", lambda: (core.status(now), core.wake_at(now))
    yield (
        "view",
        lambda: (
            view.evicted,
            view.streams.revision,
            view.members.tags,
            view.staleness.longest_way,
        ),
    )
    yield (
        "what is echoed",
        lambda: (view.echoes.due(now), view.echoes.due(now, quickest=True), view.newcomers.met_lately(now)),
    )
    yield (
        "view of robots",
        lambda: [view.origins.robot_of("feed"), *(view.staleness.told_until(each) for each in PEERS.values())],
    )
    yield (
        "view of streams",
        lambda: [
            (view.subscribers.of(s), view.subscribers.gaining(s), view.subscribers.copies(s)) for s in view.streams
        ],
    )
    yield (
        "who competes",
        lambda: (view.contention.all(now), [view.contention.competes(now, s) for s in view.streams.own()]),
    )
    yield (
        "what is overheard",
        lambda: (view.traffic.sent_since(now - 1.0), [view.subscribers.overhears(s.robot) for s in view.streams]),
    )
    for peer in list(view.peers.values()):
        yield "peer", lambda p=peer: (p.state.number, p.inbound.latency, p.inbound.line, p.inbound.losses.share)
        yield "peer, outbound", lambda p=peer: (p.outbound.line, p.outbound.losses.share)
        yield "called", lambda p=peer: (view.members.called(p.robot), p.offset.known and p.offset.uncertainty(now))
    for stream in list(view.streams):
        schedule = stream.schedule
        yield "schedule", lambda s=schedule: (s.period, s.jitter, s.kind, s.rhythm, s.last, s.timeout, s.prospect())
        yield "forecast", lambda s=schedule: (s.over(now), s.forecast(now, now + 5.0, 5), s.forecast(0.0, now, 9, now))
        yield "stream", lambda s=stream: (s.forecasts, s.expected(now) if s.last else None)
    yield (
        "coordination",
        lambda: (core.coordination.team.splits, core.coordination.due_at(now), core.coordination.settled),
    )
    yield "what we may use", lambda: [(budget.whole(now, k), budget.used(now, k)) for k in limits]
    yield "what is free", lambda: (budget.free(now), budget.others(now))
    yield "what fits", lambda: (budget.lacking(now, use), budget.opens(now, use))
    yield (
        "limits",
        lambda: (budget.problem_limits(now), budget.alone, [gate.appraisal.mode_of(s) for s in view.streams.own()]),
    )
    yield "capacity", lambda: (capacity.staleness(now), capacity.due_at, capacity.factors, capacity.wakes_at(now))
    yield "reports", lambda: (capacity.probe_due(now), capacity.has_news(now), capacity.report(now))
    yield "announcements", lambda: (gossip.announcements.share(()), gossip.announcements.due_at(now))
    yield "gossip", lambda: (gossip.due_at(now), gossip.states.state, gossip.account.window)
    yield "allowance", lambda: gossip.budget.due(now, apart=0.0, copies=2)
    yield "allowance ahead", lambda: (gossip.budget.due_ahead(now, 1.0), gossip.budget.due_in_turn(now, now, 1.0, 2))
    yield "counts", lambda: (core.counts.conserved, core.counts.queued, core.mismatched.warnings())


def whole(thing, seen=None):
    """Return all of the state that hangs on something, as values that compare."""
    seen = set() if seen is None else seen
    thing = repr(thing) if isinstance(thing, float) else thing.tolist() if isinstance(thing, np.ndarray) else thing
    if isinstance(thing, (str, bytes, int, type(None), Enum, type, Specs, InformationType)) or callable(thing):
        return thing
    if id(thing) in seen:
        return "seen"
    seen.add(id(thing))
    if isinstance(thing, Mapping | MappingProxyType):
        return [(whole(key, seen), whole(value, seen)) for key, value in thing.items()]
    if isinstance(thing, list | tuple | deque):
        return [whole(each, seen) for each in thing]
    if isinstance(thing, set | frozenset):
        return sorted(map(repr, thing))
    names = [*getattr(thing, "__dict__", ()), *(n for c in type(thing).__mro__ for n in getattr(c, "__slots__", ()))]
    return {
        f"{type(thing).__name__}.{name}": whole(getattr(thing, name), seen)
        for name in names
        if f"{type(thing).__name__}.{name}" not in KEPT and hasattr(thing, name)
    }


def differences(before, after, path=""):
    """Name the fields that differ."""
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        return [d for name in before for d in differences(before[name], after[name], name)]
    if isinstance(before, list | tuple) and isinstance(after, list | tuple) and len(before) == len(after):
        return [d for pair in zip(before, after, strict=True) for d in differences(*pair, path)]
    return [] if before == after else [path]


COORDINATION = pytest.mark.parametrize("coordination", ["announce", "split"])


@COORDINATION
@hypothesis_settings(deadline=None)
@given(acts=st.lists(ACTS, max_size=40))
def test_no_query_changes_the_state_of_a_core(coordination, acts):
    """Whatever happened before, and not even much later; but for what is only kept not to be worked out again."""
    driven = Driven(coordination)
    for act in acts:
        driven.act(*act)
    before = whole(driven.core)
    for now in (driven.now, driven.now + 0.7, driven.now + 30.0):
        for _, ask in queries(driven.core, now):
            ask()
    assert differences(before, whole(driven.core)) == []


@COORDINATION
@hypothesis_settings(deadline=None)
@given(acts=st.lists(st.tuples(ACTS, st.booleans()), max_size=40))
def test_a_core_that_is_queried_does_the_same_as_one_that_is_not(coordination, acts):
    """All commands are the same, whenever somebody looked."""
    watched, alone = Driven(coordination), Driven(coordination)
    for act, look in acts:
        watched.act(*act)
        alone.act(*act)
        for _, ask in queries(watched.core, watched.now) if look else ():
            ask()
        assert watched.said == alone.said
    assert whole(watched.core.status(watched.now)) == whole(alone.core.status(alone.now))


def test_the_status_of_a_fresh_core_changes_no_coordination():
    """Who asks how it is does not make a robot split."""
    for coordination in ("announce", "split"):
        core = Core(CoreSettings("r1", "0000000001", coordination=coordination, settle=0.3), SPECS, 0.0)
        core.status(5.0)
        assert core.wake_at(5.0) >= 5.0
        assert core.coordination.team.splits is (coordination == "split")
