"""Adaptive limits: how much of each the channel bears, by our own evidence and by what the others tell of theirs.

Every robot watches how long digests wait on their way, here and there, and whether anything gets through; from that it
estimates what the channel bears and tells it in its digests (`words.py`). Where one robot leads, what it has in force
holds for all, so all keep to the same limit, and only its estimate grows. The others follow it up and down, and object
when they see a queue: that decreases it for all, once, for who hears of it waits for the effect.

After a decrease the queue has to drain: until then less is in force, which passes, so it is told beside what lasts. All
would begin anew at once when it has; so they do one after the other.
"""

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from proxy.core.congestion.aimd import Estimate
from proxy.core.congestion.capacity_reports import Words
from proxy.core.congestion.delivery_ratio import HELPED, LOST, SPAN, Arrivals
from proxy.core.congestion.liveness import Hearing
from proxy.core.congestion.load import SPAN as SPAN_OF_USE
from proxy.core.congestion.load import Load
from proxy.core.congestion.queue_delay import NEW, Queue, Ways, queue
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

BEARABLE, BEHIND = 0.05, 2.0
"""Digests may wait so long [s], besides so many times what the longest sample takes: robots send independently."""
LONGEST = 0.25
"""The time of the longest sample counts up to this [s]."""
PACE = 0.1
"""The channel is looked at this often at most [s]."""
USED, HALF_USED = 0.85, 0.5
"""A limit is used when this part of it is, or the lesser part, and samples had to be dropped."""
MOSTLY = 0.6
"""Who uses so much of a limit uses it."""
AHEAD = 1.3
"""An estimate above the limit in force is not tested: it grows no further than so many times that."""
BEAT = 0.25
"""Digests of ours are so far apart at most while the channel is in use [s], if the allowance lets them."""
RECENT = 0.8
"""Delays are as old as this at most [s], or as twice the time between digests."""
WIDEST = 0.5
"""Bursts of limits with longer windows are taken for queues [s]."""
LONGEST_TURN = 1.0
"""When a queue has drained all robots send again within a window, but not later than this [s]."""
LATELY = 2.5
"""The others say something often if much was used so long ago [s]."""
FADING = 1.0
"""Silence decreases the estimates this often [s]."""
SAID = 64
"""Digests of ours remembered for their echoes."""
FELL, ROSE = 0.98, 1.15
"""Others are told at once when an estimate fell or rose to so much of what they were told last."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What the view knows of the use of the channel: samples `dropped` so far by anybody, whom our samples go to.

    `longest` is the time that the longest sample takes on a channel that is as the limits are now [s], `each` the part
    of every adaptive limit's ceiling that one sample of each stream takes together, and `one` the largest of these.
    The word of the `leader` counts for all.
    """

    dropped: int
    receivers: Collection[str]
    longest: float
    each: tuple[float, ...]
    one: tuple[float, ...]
    leader: str = ""


@dataclass(frozen=True, slots=True)
class _Trial:
    """Estimates were decreased from these `parts` because so much was `lost`; at `until` [s] it shows if that helps."""

    until: float
    lost: float
    parts: tuple[float, ...]


class Capacity:
    """The adaptive limits among `limits`, which are those of the ceilings."""

    def __init__(self, now: float, own: str) -> None:
        self._own = own
        self._limits: tuple[Limit, ...] = ()
        self._estimates: list[Estimate] = []
        self._force: list[float] = []
        self._lasting: list[float] = []
        """What is in force when queues have drained."""
        self._drained: list[float] = []
        """What is in force for who begins anew first."""
        self._turns: list[tuple[float, float]] = []
        """Until when we send less, and how much, because a queue was there [s]."""
        self._others_told: list[float] = []
        self._used: tuple[float, ...] = ()
        self._ways: dict[str, Ways] = {}
        self._words = Words(own)
        self._last_told: tuple[float, ...] = ()
        self._load = Load()
        self._hearing = Hearing(now)
        self._arrivals = Arrivals()
        self._said: dict[float, int] = {}
        """How many messages we had put on the air when our last digests were sent."""
        self._trial: _Trial | None = None
        self._looked_at = now
        self._free_at = now
        """When growth began or was last granted [s]."""
        self._faded_at = now
        self._most_dropped = 0
        self._pressed_until = now
        self._queue: Queue | None = None
        self._why = "nobody is there"
        self._used_at = -math.inf

    def set_limits(self, now: float, limits: Iterable[Limit]) -> None:
        """The constraints in force are now these; estimates of limits of the same name stay."""
        before = {limit.name: estimate for limit, estimate in zip(self._limits, self._estimates, strict=True)}
        self._limits = tuple(limit for limit in limits if limit.least < 1.0)
        self._trial = None
        self._estimates = [before.get(each.name) or Estimate(now, each.least) for each in self._limits]
        for limit, estimate in zip(self._limits, self._estimates, strict=True):
            estimate.floor = limit.least
        self._force = [estimate.told(now) for estimate in self._estimates]
        self._lasting = [estimate.part for estimate in self._estimates]
        self._drained = list(self._force)
        self._turns = [(now, 1.0)] * len(self._estimates)
        self._others_told = [1.0] * len(self._estimates)
        self._used = (0.0,) * len(self._estimates)

    def heard(self, now: float, digest: Digest) -> None:
        """A digest of another robot arrived."""
        if not self._estimates:
            return
        if not self._ways:
            self._hearing.restart(now)
        ways = self._ways.setdefault(digest.tag, Ways())
        if ways.here.note(now, digest.sent, now):
            self._hearing.heard(now, ways.here.waited)
        for echo in digest.echoes:
            if echo.peer == self._own and ways.there.note(now, echo.sent, echo.received):
                self._hearing.heard_by(now)
                if echo.sent in self._said:
                    self._arrivals.note(now, self._said[echo.sent], digest.tag, echo.samples)
        if digest.brief:
            return
        self._load.note(now, digest.tag, digest.sent, digest.messages, digest.bytes)
        self._words.note(now, digest)

    def gauged(self, now: float, peer: str, wait: float) -> None:
        """What we send a robot now is that long on its way [s], as our own socket tells."""
        if peer in self._ways:
            self._ways[peer].link.note(now + wait, now, now + wait)

    def sent(self, now: float, messages: int, size: int) -> None:
        """So much was put on the air by us so far."""
        self._load.note(now, self._own, now, messages, size)

    def forget(self, peer: str) -> None:
        """A robot left: it is no evidence of anything."""
        self._ways.pop(peer, None)
        self._words.forget(peer)
        self._load.forget(peer)
        self._arrivals.forget(peer)
        self._most_dropped = 0

    def waiting(self, now: float) -> float:
        """How long news of others wait on their way here [s]."""
        overdue = self._hearing.stale(now) if self._why == "overdue" else 0.0
        return max(overdue, self._queue.delay if self._queue else 0.0)

    def due(self, now: float) -> bool:
        """Whether it is time to look at the channel."""
        return bool(self._estimates) and now >= self._looked_at + PACE

    def look(self, now: float, seen: Seen) -> None:
        """Grow or decrease the estimates by what is seen now."""
        self._looked_at, words = now, self._words
        words.follow(now, seen.leader)
        self._note_drops(now, seen.dropped)
        bearable = BEARABLE + BEHIND * min(seen.longest, LONGEST)
        recent = now - max(RECENT, 2.0 * self._hearing.gap(now))
        settled = max(estimate.settled_at for estimate in self._estimates)
        self._queue = self._worst(now, seen.receivers, -math.inf, recent, bearable)
        new = self._worst(now, seen.receivers, settled, recent, bearable)
        used = self._used = words.used(self._limits) or self._load.parts(now, self._limits)
        self._used_at = now if self._in_use else self._used_at
        if not self._ways:
            self._why = "nobody is there"
        elif self._hears_nothing(now, bearable):
            self._queue = None
        elif new is not None and new.delay > bearable:
            self._why = "delay"
            self._trial = None
            self._cut(now, used, new)
        elif self._queue is not None and self._queue.delay > bearable:
            self._why = "draining"
            for estimate in self._estimates:
                estimate.linger(now, self._queue.delay)
        elif self._judge_loss(now, used):
            self._why = "loss"
        elif self._queue is None or new is None:
            self._why = "settling"
        elif self._queue is not None and self._queue.delay > bearable / 2.0:
            self._why = "some delay"
        else:
            self._rise(now, used, seen)
        if self._why not in ("free", "settling"):
            self._free_at = now
        self._combine(now, seen.receivers)

    @property
    def factors(self) -> tuple[float, ...]:
        """Of every adaptive limit, the part of its ceiling that is in force."""
        return tuple(self._force)

    def wake_at(self, now: float) -> list[float]:
        """When limits change by themselves [s]."""
        return [t for estimate in self._estimates if (t := estimate.drained_at) > now]

    def speak(self, now: float) -> bool:
        """Whether it is time for a digest of ours for its way alone: the channel is in use, and that tells of it."""
        asked = self._in_use or now < self._pressed_until
        return asked and bool(self._ways) and now >= self._hearing.last_said + BEAT

    def news(self, now: float) -> bool:
        """Whether the others should hear at once what we would tell them."""
        told = self.telling(now)
        if len(told) > len(self._last_told):
            return True
        count = len(self._estimates)
        places = [k for k in range(len(told)) if not count <= k < 2 * count]
        pairs = [(told[k], self._last_told[k]) for k in places]
        return any(new < FELL * old or new > ROSE * old for new, old in pairs)

    def telling(self, now: float) -> tuple[float, ...]:
        """What a digest says: of every adaptive limit, the part that the channel bears by our evidence.

        Who leads says what it has in force, by the evidence of all, and of every limit the part that is used by all.
        Who follows and has nothing against that says so, as does who knows of nothing against more.
        """
        if self._words.leads:
            drains = self._drained if self._drained != self._lasting else ()
            return (*self._lasting, *(min(used, 1.0) for used in self._used), *drains)
        if self._words.follows:
            pairs = zip(self._estimates, self._others_told, strict=True)
            return tuple(estimate.part if estimate.part < FELL * others else 1.0 for estimate, others in pairs)
        return tuple(estimate.told(now) if estimate.bounded else 1.0 for estimate in self._estimates)

    def told(self, digest: Digest) -> None:
        """This digest of ours goes out."""
        self._last_told = digest.capacity
        self._hearing.said(digest.sent)
        self.said(digest.sent, digest.messages)

    def said(self, now: float, messages: int) -> None:
        """A digest of ours goes out when so many messages were put on the air: its echo tells what arrived of them."""
        self._said[now] = messages
        if len(self._said) > SAID:
            del self._said[next(iter(self._said))]

    def described(self, now: float, number: int) -> dict[str, Any]:
        """An adaptive limit as plain JSON data: parts of its ceiling, and what it reacts to."""
        return {
            "in_force": self._force[number],
            "estimate": self._estimates[number].part,
            "told": self._estimates[number].told(now),
            "floor": self._limits[number].least,
            "ceiling": self._limits[number].limit,
            "used": self._used[number],
            "delay": self._queue.delay if self._queue else None,
            "lost": self._arrivals.lost(now),
            "reason": self._why,
        }

    def _note_drops(self, now: float, dropped: int) -> None:
        """More than ever before: a sample that still waits for its decision looks like a dropped one for a moment."""
        if dropped > self._most_dropped:
            self._pressed_until = now + 1.0
            self._most_dropped = dropped

    def _worst(
        self, now: float, receivers: Collection[str], since: float, recent: float, bearable: float
    ) -> Queue | None:
        """The longest that stands before what comes here, or before what we send to those whom it matters to.

        A limit lets what it bears in its window be sent at once: a queue stands if it outlasts that.
        """
        span = min(max(NEW, *(limit.window for limit in self._limits)), WIDEST)
        outward = [ways for peer, ways in self._ways.items() if not receivers or peer in receivers]
        links = [ways.link for ways in outward]
        inward = list(self._ways.values())
        groups = [[ways.here for ways in inward], [ways.there for ways in outward], links]
        found = [queue(now, ways, since, bearable / 2.0, recent=recent, span=span) for ways in groups]
        return max((each for each in found if each), key=lambda each: each.delay, default=None)

    def _hears_nothing(self, now: float, bearable: float) -> bool:
        """Whether nothing comes through, or what is overdue may wait in a queue; then less is sent."""
        if self._hearing.silent(now):
            self._why = "silence"
            self._fade(now)
            return True
        if now < self._used_at + LATELY and self._hearing.overdue(now, bearable, len(self._ways)):
            self._why = "overdue"
            for estimate in self._estimates:
                estimate.hold(now)
            return True
        return False

    def _fade(self, now: float) -> None:
        if now >= self._faded_at + FADING:
            self._faded_at = now
            for estimate in self._estimates:
                estimate.fade()

    def _cut(self, now: float, used: Sequence[float], standing: Queue) -> None:
        for part, force, estimate in zip(used, self._lasting, self._estimates, strict=True):
            # Whole samples never fill a limit; much less than it means that others than us fill the channel.
            # So soon after another decrease what is used says little.
            lately = now < estimate.settled_at + 2.0 * SPAN_OF_USE
            borne = force if lately else min(max(part / MOSTLY, 0.5 * force), force)
            estimate.cut(now, borne, standing.share, standing.delay)

    def _judge_loss(self, now: float, used: Sequence[float]) -> bool:
        """Whether a decrease is on trial because of loss; begin one, and end it with what it shows."""
        lost, trial = self._arrivals.lost(now), self._trial
        if trial is None and lost > LOST and all(now >= estimate.settled_at + SPAN for estimate in self._estimates):
            self._trial = _Trial(now + 2.0 * SPAN, lost, tuple(estimate.part for estimate in self._estimates))
            self._arrivals.blame(now)
            self._cut(now, used, Queue(0.0, 1.0 - lost))
        elif trial is not None and now < trial.until:
            self._trial = replace(trial, lost=max(lost, trial.lost))
        elif trial is not None:
            self._trial = None
            if lost > HELPED * trial.lost:
                self._arrivals.accept()
                for estimate, part in zip(self._estimates, trial.parts, strict=True):
                    estimate.restore(part)
        return self._trial is not None

    def _rise(self, now: float, used: Sequence[float], seen: Seen) -> None:
        """Nothing stands in the way that we know of."""
        self._why = "free"
        if self._words.follows:
            self._catch_up(now)
        else:
            self._grow(now, used, seen)

    def _grow(self, now: float, used: Sequence[float], seen: Seen) -> None:
        """Grow what is used, or what is too small for a sample of each stream: robots may wait for their turn then."""
        elapsed = min(now - self._free_at, max(1.0, self._hearing.gap(now)))
        self._free_at = now
        pressed = now < self._pressed_until
        for k, (force, estimate) in enumerate(zip(self._force, self._estimates, strict=True)):
            full = used[k] >= (HALF_USED if pressed else USED) * force
            if full or (pressed and max(used[k] + seen.one[k], seen.each[k]) > force):
                # Nothing when only we see what is lost by load; and who leads knows no better than it says.
                others = 0.0 if self._arrivals.blamed(now) else self._words.least(now, k)
                estimate.grow(now, elapsed, AHEAD * force, min(others, force) if self._words.leads else others)
            else:
                self._why = "not used"

    def _catch_up(self, now: float) -> None:
        """Come to what the leader has in force."""
        elapsed, self._free_at = now - self._free_at, now
        for estimate, word in zip(self._estimates, self._others_told, strict=True):
            estimate.grow(now, elapsed, word, word)

    def _combine(self, now: float, receivers: Collection[str]) -> None:
        """Put in force what all tell together."""
        words = self._words
        for k, estimate in enumerate(self._estimates):
            others = words.bound(now, k, self._limits[k], receivers)
            if others < FELL * self._others_told[k] and others < estimate.told(now):
                estimate.wait(now)
            if words.follows:
                estimate.follow(others, agrees=estimate.part >= FELL * self._others_told[k])
            elif words.leads and others < FELL * estimate.part:
                estimate.heed(now, others, self._queue.delay if self._queue else 0.0)
            self._others_told[k] = others
            self._lasting[k] = min(estimate.part, others)
            self._drained[k] = min(estimate.told(now), others, words.draining(now, k, len(self._limits)))
            self._force[k] = self._in_turn(now, k)

    def _in_turn(self, now: float, k: int) -> float:
        """What is in force: when a queue has drained robots begin anew one after the other, within a window."""
        if self._drained[k] < FELL * self._lasting[k]:
            names = sorted((self._own, *self._ways))
            turn = min(self._limits[k].window, LONGEST_TURN) * names.index(self._own) / len(names)
            self._turns[k] = now + turn, self._drained[k]
        begins, low = self._turns[k]
        return min(self._drained[k], low) if now < begins else self._drained[k]

    @property
    def _in_use(self) -> bool:
        """Whether much of any limit in force is used."""
        return any(part > HALF_USED * force for part, force in zip(self._used, self._force, strict=True))
