"""Extracts the features of covered samples, off the Zenoh callbacks and off the loop."""

import threading
from collections import Counter, deque
from collections.abc import Callable, Mapping
from dataclasses import replace

import zenoh

from proxy.core.events import SamplePublished
from utility_specs import InformationType

_REMEMBERED = 4096

Job = tuple[SamplePublished, InformationType, zenoh.ZBytes]


class Extractor:
    """Posts each sample with what its type extracts, in order of arrival.

    When it falls behind, a sample of a Markovian type whose key has a newer one waiting takes over the features of
    its predecessor: the newer one will supersede it anyway, so the backlog costs one extraction per key. Its
    length is bounded by what ingress holds.
    """

    def __init__(self, post: Callable[[SamplePublished], None]) -> None:
        self._post = post
        self._jobs: deque[Job] = deque()
        self._waiting: Counter[str] = Counter()
        self._last: dict[str, Mapping[str, float]] = {}
        self._wake = threading.Condition()
        self._open = True
        self._thread = threading.Thread(target=self._run, name="features", daemon=True)
        self.skipped = 0

    def start(self) -> None:
        """Start extracting."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop; wait at most `timeout` [s] for the extraction in hand."""
        with self._wake:
            self._open = False
            self._wake.notify()
        self._thread.join(timeout)

    def submit(self, event: SamplePublished, covering: InformationType, payload: zenoh.ZBytes) -> None:
        """Post `event` with its features, soon. Whatever needs no payload does not wait for what does.

        A delete has no features, but waits its turn behind the samples of its key.
        """
        if not covering.needs_payload:
            self._post(event if event.delete else replace(event, features=covering.extract(event.key, b"")))
        else:
            with self._wake:
                self._jobs.append((event, covering, payload))
                self._waiting[event.key] += 1
                self._wake.notify()

    def _run(self) -> None:
        while True:
            with self._wake:
                while self._open and not self._jobs:
                    self._wake.wait()
                if not self._open:
                    return
                event, covering, payload = self._jobs.popleft()
                self._waiting[event.key] -= 1
                newer = self._waiting[event.key] > 0
                if not newer:
                    del self._waiting[event.key]
            self._post(replace(event, features=self._features(event, covering, payload, newer=newer)))

    def _features(
        self, event: SamplePublished, covering: InformationType, payload: zenoh.ZBytes, *, newer: bool
    ) -> Mapping[str, float]:
        if event.delete:
            return {}
        if newer and covering.markovian and event.key in self._last:
            self.skipped += 1
            return self._last[event.key]
        features = covering.extract(event.key, payload)
        self._last.pop(event.key, None)
        self._last[event.key] = features
        if len(self._last) > _REMEMBERED:
            del self._last[next(iter(self._last))]
        return features
