"""Hands covered samples to the core with their features, extracted off the loop.

The thread that brings a sample extracts them itself where they are known to be quick and no other sample waits: to wake
another one takes long where the cores are busy. It has as much time for all else, for it is one of Zenoh's.

Where only the most recent sample of a stream counts, the core is not told of more than it can use: while one of a key
has not been taken up, a newer one takes its place. That costs neither an extraction nor an event. Where all samples of
a key go whatever else comes none gives way, unless many wait: beside eight busy loops a stream of 500 Hz lost 31 % of
its samples though all had room.
What takes longer than its budget, or may never end, is computed in the background, so that no stream waits for another
one's features.
"""

import math
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import zenoh

from proxy import clock
from proxy.background import Background
from proxy.core.interface.events import SamplePublished, SampleReread
from proxy.tuning import TUNING
from utility_specs import InformationType


@dataclass(slots=True)
class _Place:
    """What the core will be told: the newest sample of its key so far, and how many it superseded."""

    event: SamplePublished | SampleReread
    key: str
    covering: InformationType
    payload: zenoh.ZBytes
    attachment: zenoh.ZBytes | None
    replaceable: bool = False
    """Whether a newer sample may take it."""
    superseded: int = 0
    ahead: int = 0
    """How many of its key waited before it, at most, which did not give way."""

    def supersede(self, event: SamplePublished, payload: zenoh.ZBytes, attachment: zenoh.ZBytes | None) -> int:
        """Let a newer sample take the place; return the number of the one that had it."""
        gone = self.event.sample
        self.event, self.payload, self.attachment = event, payload, attachment
        self.superseded += 1
        return gone


class Extractor:
    """Posts each sample with what its type extracts, in order of arrival, or a newer one of its key in its place.

    `post_at` runs a job on the loop's thread, not before a time. `lead` has the core take in a sample at once, if that
    only has to be sent on and nothing waits before it, and `bring` does a job on this thread, if nothing waits; both
    return whether they did. `goes` says whether all samples of a key go whatever else comes. `match` finds the type
    that covers a key by the specs in force, which change only while nobody else uses the core: it gets no features of
    others. What waits is bounded by what ingress holds.
    """

    def __init__(
        self,
        post_at: Callable[[float, Callable[[], SamplePublished | SampleReread]], None],
        match: Callable[[str], InformationType | None],
        lead: Callable[[SamplePublished], bool] = lambda _: False,
        bring: Callable[[Callable[[], SamplePublished | SampleReread]], bool] = lambda _: False,
        goes: Callable[[str], bool] = lambda _: False,
    ) -> None:
        self._post_at = post_at
        self._lead = lead
        self._bring = bring
        self._goes = goes
        self._match = match
        self._jobs: deque[_Place] = deque()
        self._places: dict[str, _Place] = {}
        """The last place of each key that has not been taken up: what comes later waits behind it."""
        self._next: dict[str, float] = {}
        self._noting = threading.Lock()
        self._wake = threading.Condition()
        self._open = True
        self._extracting = False
        """Whether a thread sees to a sample: one at a time, so that none overtakes another of its key."""
        self._free_at = -math.inf
        """When a thread that brings a sample may see to it [s]."""
        self._thread = threading.Thread(target=self._run, name="features", daemon=True)
        self._background = Background()
        self.superseded = 0

    def warnings(self, now: float) -> list[str]:
        """Say when a feature does not come to its end."""
        return self._background.warnings(now)

    def close(self, timeout: float) -> None:
        """Stop; wait at most `timeout` [s] for the extractions in hand."""
        with self._wake:
            self._open = False
            self._wake.notify()
        end = clock.monotonic() + timeout
        if self._thread.ident is not None:
            self._thread.join(timeout)
        self._background.close(max(0.0, end - clock.monotonic()))

    def submit(
        self,
        event: SamplePublished,
        covering: InformationType,
        payload: zenoh.ZBytes,
        attachment: zenoh.ZBytes | None = None,
        *,
        each: bool = False,
    ) -> int | None:
        """Post `event` with its features, soon; return the sample whose place it took, if there was one.

        With `each` it takes none and leaves none to others: where all of them go, none may be superseded. Whatever
        needs no payload does not wait for what does. A delete has no features, but waits its turn behind the samples
        of its key, and those that come later wait behind it.
        """
        if self._goes_at_once(event, covering) or self._extracts_at_once(event, covering, payload, attachment):
            return None
        with self._wake:
            place, ahead = self._places.get(event.key), 0
            if place is not None and place.replaceable and not event.delete and not each:
                if covering.needs_payload or place.ahead >= TUNING.none_gives_way or not self._goes(event.key):
                    self.superseded += 1
                    return place.supersede(event, payload, attachment)
                ahead = place.ahead + 1
            replaceable = covering.markovian and not event.delete and not each
            self._add(_Place(event, event.key, covering, payload, attachment, replaceable, ahead=ahead))
            return None

    def _goes_at_once(self, event: SamplePublished, covering: InformationType) -> bool:
        """Whether the core took in a sample that has no features, before which none of its key waits."""
        key, now = event.key, event.now
        due = self._next.get(key, now)
        if covering.features or key in self._places or due > now + TUNING.uptakes_ahead or not self._lead(event):
            return False
        if covering.markovian:
            self._take_up(key, max(due, now) + TUNING.uptake_interval)
        return True

    def _extracts_at_once(
        self,
        event: SamplePublished,
        covering: InformationType,
        payload: zenoh.ZBytes,
        attachment: zenoh.ZBytes | None,
    ) -> bool:
        """Whether the core has a sample, with quick features, before which none waits for its own."""
        if not covering.needs_payload or event.delete or event.now < self._free_at or self._jobs or self._extracting:
            return False
        if event.key in self._places or not covering.extracts_within(event.key, TUNING.extracted_at_once):
            return False
        with self._wake:
            if not self._open or self._jobs or self._extracting:
                return False
            self._extracting = True
        try:
            self._see_to(_Place(event, event.key, covering, payload, attachment))
        finally:
            now = clock.monotonic()
            with self._wake:
                self._extracting, self._free_at = False, now + (now - event.now)
                if self._jobs:
                    self._wake.notify()
        return True

    def reread(
        self, event: SampleReread, key: str, payload: zenoh.ZBytes, attachment: zenoh.ZBytes | None = None
    ) -> None:
        """Post `event` with the features of a sample that the core knows already, by the specs in force."""
        covering = self._match(key)
        if covering is None:
            self._post_at(event.now, lambda: event)
            return
        with self._wake:
            self._add(_Place(event, key, covering, payload, attachment))

    def _add(self, place: _Place) -> None:
        self._places[place.key] = place
        if place.covering.needs_payload:
            self._jobs.append(place)
            if self._thread.ident is None:  # most specs look into no payload
                self._thread.start()
            self._wake.notify()
        else:
            self._post(place, TUNING.uptake_interval if place.replaceable and not place.ahead else 0.0)

    def _post(self, place: _Place, pause: float) -> None:
        """Let the loop take up the place when its time has come; the next one of its key `pause` [s] later."""
        key, now = place.key, place.event.now
        when = max(now, self._next.get(key, now))
        self._take_up(key, when + pause)
        self._post_at(when, lambda: self._current(place, self._taken(place)))

    def _take_up(self, key: str, until: float) -> None:
        """Note that the core takes up a sample of a key; the next one it takes up then [s]."""
        with self._noting:
            self._next.pop(key, None)
            self._next[key] = until
            if len(self._next) > TUNING.uptakes:
                del self._next[next(iter(self._next))]

    def _run(self) -> None:
        while True:
            with self._wake:
                while self._open and (self._extracting or not self._jobs):
                    self._wake.wait()
                if not self._open:
                    return
                self._extracting = True
                place = self._jobs.popleft()
            self._see_to(place)
            with self._wake:
                self._extracting = False

    def _see_to(self, place: _Place) -> None:
        """Extract the features of the sample in a place, and have the core take it in."""
        event = self._taken(place)
        job = partial(self._current, place, event)
        if not self._bring(job):
            self._post_at(event.now, job)

    def _taken(self, place: _Place) -> SamplePublished | SampleReread:
        """Close the place, and return the sample that is in it with its features."""
        with self._wake:
            if self._places.get(place.key) is place:
                del self._places[place.key]
        return self._extracted(place)

    def _current(self, place: _Place, event: SamplePublished | SampleReread) -> SamplePublished | SampleReread:
        """Return the event, on the loop's thread; with other features when specs have changed meanwhile."""
        covering = self._match(place.key)
        if covering is place.covering or covering is None:
            return event
        return self._extracted(replace(place, covering=covering))

    def _extracted(self, place: _Place) -> SamplePublished | SampleReread:
        event = place.event
        if isinstance(event, SamplePublished) and event.delete:
            return replace(event, features={}, superseded=place.superseded)
        features = place.covering.extract(place.key, place.payload, place.attachment, self._background)
        if not features and not place.superseded:
            return event
        if isinstance(event, SampleReread):
            return replace(event, features=features)
        return replace(event, features=features, superseded=place.superseded)
