"""The fast path: a sample before which nothing waits goes at once, while there is ample room for all that may be sent.

What such samples change is noted here, and entered in order before anything else happens or anybody looks (`settle`):
an event touches three files of the core, not 56. The path is open until something is due, or to be told; not where a
sample waits or limits follow the channel or are split, nor for streams that are new, guaranteed, of `once`, or kept for
others.
"""

import math
from collections.abc import Mapping, Sequence

from proxy.core.interface.commands import Command, Forward
from proxy.core.interface.events import Event, SampleHanded, SamplePublished
from proxy.core.model.limits import changes_plans, use_of
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.parts import Parts
from proxy.core.samples.outcomes import Run
from proxy.core.view.stream import Generated, Sent, Stream

LARGER = 2.0
"""A sample may be so many times as large as the last one whose need was looked at: there is room for so much more."""
MOST_NOTED = 256
"""So many samples are noted at most before they are entered."""
MOST_SIZES = 64
"""Of so many sizes of each stream it is remembered what they use."""
FORWARDED = "forwarded"


class _Lane:
    """A stream whose samples go at once. `raw` are the features of all of them, as they are extracted."""

    __slots__ = ("copies", "features", "handed", "largest", "raw", "scale", "stream", "uses")

    def __init__(self, stream: Stream, raw: Mapping[str, float], copies: int) -> None:
        last = stream.newest
        self.stream = stream
        self.raw = raw
        self.features, self.scale = last.features, last.scale
        self.copies = copies
        self.handed = 0
        """Samples that the mesh session took since the last settling."""
        self.largest = LARGER * last.size
        self.uses: dict[int, tuple[float, ...]] = {}
        """What a sample of each size uses of the limits."""

    def hand(self) -> bool:
        """The mesh session took a sample; return whether it is the first one since the last settling."""
        self.handed += 1
        return self.handed == 1

    def take_handed(self) -> int:
        """Return how many samples it took since the last settling: that is now."""
        handed, self.handed = self.handed, 0
        return handed

    def enter(self, event: SamplePublished) -> None:
        """A sample passed: note it in the stream. It went to the same robots as the one before."""
        stream, now, size, scale, features = self.stream, event.now, event.size, self.scale, self.features
        stream.note_generated(stream.generated + 1, Generated(event.t_gen, size, scale, features))
        stream.note_sent(stream.forwarded + 1, Sent(min(event.t_gen, now), now, size, scale, features))
        self.largest = LARGER * size


_Noted = tuple[_Lane, SamplePublished, tuple[float, ...]]
"""A sample that passed, its lane, and what it uses of each limit."""


class FastPath:
    """Sends what surely may go, and remembers what is to be entered for it."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._counts = parts.counts
        self._own = parts.view.origins.own
        self._traffic = parts.view.traffic
        self._lanes: dict[str, _Lane] = {}
        self._until = -math.inf
        """Until when the fast path is open [s]."""
        self._tells_at = math.inf
        """When what samples bring is told [s]."""
        self._room: list[float] = []
        """What is left of each limit at least."""
        self._heard = -1
        """How often others' traffic had changed by then."""
        self._known: tuple[object, ...] = ()
        """What all lanes depend on."""
        self._noted: list[_Noted] = []
        self._handed: list[_Lane] = []
        self._passed = 0
        """Samples that passed since it was opened."""
        self._entered: dict[str, Stream] = {}
        """The streams whose needs have to be looked at, as samples of them were entered..."""
        self._last_at = -math.inf
        """... of which the last one came then [s]."""

    @property
    def due_at(self) -> float:
        """When something is to be told of the samples that are noted [s]."""
        return self._tells_at if self._noted else math.inf

    def take(self, event: Event) -> list[Command] | None:
        """Do what an event asks for, if that is all that has to be done now; None where it is not."""
        if event.now >= self._until:
            return None
        if type(event) is SamplePublished:
            return self._pass(event)
        if type(event) is SampleHanded:
            return self._note_handed(event.sample)
        return None

    def open(self, now: float, until: float) -> None:
        """See whether samples may pass from now on, until something is due [s]."""
        self._until = -math.inf
        parts, view, appraisal = self._parts, self._parts.view, self._parts.gate.appraisal
        coordination, digests = parts.coordination, parts.gossip.digests
        if now >= until or not (appraisal.ample and appraisal.look_for_room(now) and appraisal.ample):
            return
        if coordination.told is not None or parts.budget.alone or coordination.team.undecided:
            return
        if parts.gate.waits or digests.urgent or parts.channel.capacity.factors:
            return
        self._tells_at = digests.gathers_until
        if now >= self._tells_at or now < view.newcomers.greeted_by(now):
            return
        known = view.streams.revision, view.members.unannounced, parts.budget.limits
        if known != self._known:
            self._known = known
            self._lanes.clear()
        self._until, self._passed = min(until, self._tells_at), 0
        self._room, self._heard = parts.budget.free(now), self._traffic.revision

    def close(self) -> None:
        """Something changed that any stream may depend on: samples go the long way until they are admitted anew."""
        self._until = -math.inf
        self._lanes.clear()

    def admit(self, event: SamplePublished) -> None:
        """A sample went the long way; see whether the next ones of its stream may pass."""
        lane = self._lanes.get(event.key)
        if lane is not None and lane.raw == event.features:
            return
        self._lanes.pop(event.key, None)
        if event.now >= self._until or event.delete:
            return
        parts, view = self._parts, self._parts.view
        stream = view.streams.known(parts.settings.robot, event.key)
        if stream is not None and self._may_pass(event, stream):
            self._lanes[event.key] = _Lane(stream, event.features, view.subscribers.copies(stream))

    def _may_pass(self, event: SamplePublished, stream: Stream) -> bool:
        parts, kind = self._parts, stream.information_type
        if (
            stream.last is None
            or stream.last.t_gen != event.t_gen
            or not parts.gate.appraisal.is_plain(event.now, stream)
        ):
            return False
        if parts.gate.appraisal.mode_of(stream) is not Mode.ENFORCE or not parts.view.subscribers.gaining(stream):
            return False
        kept = parts.settings.away and not kind.markovian
        return not kept and not parts.gossip.news.value_changed(stream)

    def _pass(self, event: SamplePublished) -> list[Command] | None:
        """Send a sample of a lane, if there is room for it."""
        lane = self._lanes.get(event.key)
        if lane is None or event.size > lane.largest or event.delete or event.superseded or lane.raw != event.features:
            return None
        if event.origin is not None and event.origin not in self._own:
            return None
        if self._traffic.revision != self._heard and not self._looks_again(event.now):
            return None
        use = lane.uses.get(event.size)
        if use is None and (use := self._use(lane, event.size)) is None:
            return None
        room = [left - amount for left, amount in zip(self._room, use, strict=True)]
        if room and min(room) < 0.0:
            return None
        self._room = room
        self._counts.forward(event.sample, event.key, FORWARDED)
        self._noted.append((lane, event, use))
        self._passed += 1
        if self._passed >= MOST_NOTED:
            self._until = -math.inf
        return [Forward(event.sample)]

    def _use(self, lane: _Lane, size: int) -> tuple[float, ...] | None:
        """Return what a sample uses; None where others plan with it, or the limits have no place for it."""
        limits = self._parts.budget.limits
        use = use_of(size, lane.copies, limits)
        if changes_plans(use, limits):
            return None
        if len(lane.uses) >= MOST_SIZES:
            lane.uses.clear()
        lane.uses[size] = use
        return use

    def _looks_again(self, now: float) -> bool:
        """Others sent something meanwhile: see what they leave. Return whether all lanes are as they were."""
        self.conclude()
        self._room, self._heard = self._parts.budget.free(now), self._traffic.revision
        return self._known[0] == self._parts.view.streams.revision

    def _note_handed(self, sample: int) -> list[Command] | None:
        """The mesh session took a sample that passed here."""
        lane = self._lanes.get(self._counts.key_of(sample))
        if lane is None or self._parts.budget.own.is_leaving(sample):
            return None
        self._counts.hand(sample)
        if lane.hand():
            self._handed.append(lane)
        return []

    def settle(self) -> None:
        """Enter what is noted wherever it belongs; who only looks changes nothing by that."""
        if self._handed:
            handed, self._handed = self._handed, []
            for lane in handed:
                self._parts.view.handed(lane.stream.key, lane.take_handed())
        if self._noted:
            noted, self._noted = self._noted, []
            self._enter(noted)

    def conclude(self) -> None:
        """Enter what is noted, and look what the streams need now: something else happens."""
        self.settle()
        if self._entered:
            entered, self._entered = self._entered, {}
            self._parts.gate.appraisal.passed(self._last_at, entered.values())

    def _enter(self, noted: list[_Noted]) -> None:
        parts, runs = self._parts, dict[str, list[int]]()
        for place, (lane, event, _) in enumerate(noted):
            lane.enter(event)
            places = runs.pop(event.key, [])
            places.append(place)
            runs[event.key] = places
        parts.gossip.states.sample_came(noted[0][1].now, noted[0][1].size, new=False)
        for _, event, use in noted:
            parts.budget.use(event.now, use)
        sizes = [lane.copies * event.size for lane, event, _ in noted]
        self._traffic.count(sum([lane.copies for lane, _, _ in noted]), sum(sizes), max(sizes))
        parts.gate.passed([(places[-1], _run(noted, places)) for places in runs.values()])
        self._last_at = noted[-1][1].now
        for key, places in runs.items():
            self._entered[key] = noted[places[-1]][0].stream


def _run(noted: Sequence[_Noted], places: Sequence[int]) -> Run:
    lane, event, _ = noted[places[-1]]
    markovian = lane.stream.information_type.markovian
    last = Waiting(
        event.sample, event.key, event.size, event.t_gen, lane.scale, event.priority, markovian, lane.features
    )
    return Run(lane.stream, noted[places[0]][1].now, event.now, last, len(places))
