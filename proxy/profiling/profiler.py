"""Takes profiles of this daemon, one at a time. Where none is asked for there is no thread and nothing to pay."""

import logging
import math
import threading
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from proxy import clock
from proxy.profiling.profile import Branch, Profile, Samples, branches
from proxy.profiling.request import ProfileError, Request

if TYPE_CHECKING:
    from proxy.profiling.sampler import Sampler

Told = Callable[[Profile | ProfileError], None]
"""Gets a profile, or why there is none."""

log = logging.getLogger(__name__)


class Profiler:
    """Profiles the daemon of a `robot`. Called on the loop's thread, to which `post` brings a job.

    `flush` has everything counted that crossed up to now, as soon as what it posts is done; `samples` are the counts.
    """

    def __init__(
        self,
        robot: str,
        post: Callable[[Callable[[], None]], None],
        flush: Callable[[], None],
        samples: Callable[[], Samples],
    ) -> None:
        self._robot = robot
        self._post = post
        self._flush = flush
        self._samples = samples
        self._ends = -math.inf
        self._told: list[Told] = []
        """Who gets the profile that is being taken, or why it failed."""
        self._sampler: Sampler | None = None
        self._thread: threading.Thread | None = None
        self.last: Profile | None = None
        """The one that was taken last."""

    def start(self, request: Request, told: Told) -> None:
        """Take a profile, which `told` gets. Raises ProfileError while another one is being taken, or LayoutError."""
        from proxy.profiling.layout import find_layout  # noqa: PLC0415 - 1 MB, with the library of C++
        from proxy.profiling.sampler import Sampler  # noqa: PLC0415

        now = clock.monotonic()
        if self._sampler is not None:
            raise ProfileError(f"a profile is being taken; it ends in {max(self._ends - now, 0.0):.1f} s")
        self._sampler = sampler = Sampler(find_layout(), request.seconds, request.rate)
        self._ends = now + request.seconds
        self._told = [told]

        def begin() -> None:
            work = partial(self._run, sampler, self._samples())
            thread = threading.Thread(target=work, name="profiler", daemon=True)
            try:
                thread.start()
            except RuntimeError as error:  # the kernel allows no more threads
                self._tell(ProfileError(f"the profile failed: {error}"))
            else:
                self._thread = thread

        self._counted(begin)

    def end(self, told: Told) -> None:
        """End the profile that is being taken; `told` gets it, too. Raises ProfileError where there is none."""
        if self._sampler is None:
            raise ProfileError("no profile is being taken")
        self._told.append(told)
        self._sampler.stop()

    def close(self, timeout: float) -> None:
        """End a profile that is being taken; wait for it at most `timeout` [s]. From any thread."""
        sampler, thread = self._sampler, self._thread
        if sampler is not None:
            sampler.stop()
        if thread is not None:
            thread.join(timeout)

    def _run(self, sampler: "Sampler", before: Samples) -> None:
        try:
            found = branches(sampler.run(), sampler.whole)
        except Exception as error:
            log.exception("the profile failed")
            failed = ProfileError(f"the profile failed: {error}")
            self._post(lambda: self._tell(failed))
            return
        self._post(lambda: self._counted(lambda: self._end(sampler, found, before)))

    def _counted(self, then: Callable[[], None]) -> None:
        """Go on when everything is counted that crossed up to now."""
        self._flush()
        self._post(then)

    def _end(self, sampler: "Sampler", found: tuple[Branch, ...], before: Samples) -> None:
        self.last = Profile(
            robot=self._robot,
            seconds=sampler.seconds,
            looks=sampler.looks,
            own=sampler.own,
            samples=self._samples().since(before),
            branches=found,
        )
        self._tell(self.last)

    def _tell(self, became: Profile | ProfileError) -> None:
        """Tell all who wait what became of the profile; the next one can be taken."""
        self._sampler = self._thread = None
        for told in self._told:
            told(became)
