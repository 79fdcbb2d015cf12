"""What a sample of ours is as things are now: what it uses, whether it is guaranteed, and how it stands."""

import math
from collections.abc import Iterable
from functools import partial

from planner import Aggregation
from proxy.core.coordination.budget import Budget, grew, sustained
from proxy.core.coordination.claims import Claims, both
from proxy.core.market.disputes import Disputes
from proxy.core.market.standing import Amounts, Standing, rate_known
from proxy.core.market.tuning import TUNING
from proxy.core.market.undersubscribed import Undersubscribed
from proxy.core.model.limits import longest_window, stretched, use_of
from proxy.core.model.mode import Mode, in_force
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView
from proxy.core.window.forecast import guaranteed, owed

Use = tuple[float, ...]
"""What a message uses of each constraint."""


class Appraisal:
    """Asks the view, the budget and the market about samples of this robot."""

    def __init__(self, view: SharedView, budget: Budget, disputes: Disputes) -> None:
        self.mode = view.settings.mode
        """What the daemon does with decisions."""
        self.view = view
        self.budget = budget
        self.disputes = disputes
        self.claims = Claims(view, disputes)
        self.all_fits = False
        """Whether there was room for all that may be sent when it was last looked at."""
        self.ample = False
        """Whether there was room for far more."""
        self._looked_at = -math.inf
        """When that was [s]."""
        self._undersubscribed = Undersubscribed(view)

    def set_mode(self, mode: Mode) -> None:
        """Do this with decisions from now on."""
        self.mode = mode

    def mode_of(self, stream: Stream | None) -> Mode:
        """What is done with decisions on a stream."""
        return self.mode if stream is None else in_force(self.mode, stream.information_type.mode)

    def stream_of(self, now: float, sample: Waiting) -> Stream | None:
        """Return the stream of a sample, which keeps it in the view; None where no spec plans for it."""
        return self.view.streams.touch(now, self.view.settings.robot, sample.key)

    def copies(self, stream: Stream | None) -> int:
        """How often a sample of the stream goes on the air."""
        return self.view.subscribers.copies(stream) if stream is not None else 1

    def use(self, stream: Stream | None, sample: Waiting) -> Use:
        """What a sample uses of the constraints in force now, which may be others than when its decision began."""
        return use_of(sample.size, self.copies(stream), self.budget.limits)

    def owed(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Whether a guarantee of the stream demands the sample."""
        return guaranteed(stream) and any(owed(stream, [sample.t_gen], self.view.audiences.of(now, stream).slowest))

    def published(self, now: float, stream: Stream) -> None:
        """The stream has generated a sample while another one is decided."""
        self._undersubscribed.note(now, stream)

    def look_for_room(self, now: float, stream: Stream | None = None, waiting: int = 0) -> bool:
        """Whether all that may be sent fits, with a sample of the `stream` and so many waiting: nothing is dropped."""
        limits, self._looked_at = self.budget.limits, now
        if limits:
            self._undersubscribed.advance(now, limits, alone=self.budget.alone)
            if stream is not None:
                self._undersubscribed.note(now, stream)
            usable = [limit.limit for limit in self.budget.usable(now)]
            self.all_fits = self._undersubscribed.fits(usable, waiting)
            self.ample = self.all_fits and self._undersubscribed.fits(usable, waiting, TUNING.ample)
        else:
            self.all_fits = self.ample = True
        return self.all_fits

    def all_go(self, key: str) -> bool:
        """Whether all samples of a key of ours go, as seen last: all fit, or none disputes these. From any thread."""
        stream = self.view.streams.known(self.view.settings.robot, key)
        return stream is not None and (self.all_fits or self.disputes.weighed(stream).standing is Standing.UNDISPUTED)

    def is_plain(self, now: float, stream: Stream) -> bool:
        """Whether a stream is like most: it is known how often it generates, and nothing is said of single samples."""
        if guaranteed(stream) or stream.information_type.aggregation is Aggregation.ONCE:
            return False
        return all(rate_known(now, stream, limit.window) for limit in self.budget.limits)

    def passed(self, now: float, streams: Iterable[Stream]) -> None:
        """Samples of these streams were sent as they came, the last one at `now` [s]."""
        self._looked_at = now
        if self.budget.limits:
            for stream in streams:
                self._undersubscribed.note(now, stream)

    def weigh(self, now: float, stream: Stream, sample: Waiting) -> Standing:
        """Weigh the streams that compete if it is time to; return how a sample stands among them."""
        self._advance(now, stream)
        return self.disputes.standing(now, stream, sample)

    def last_prices(self, now: float) -> Amounts | None:
        """Return what a unit of each limit cost when that was worked out last, 0 where all fits; None: long ago."""
        if self._looked_at < now - TUNING.known:
            return None
        if self.all_fits:
            return (0.0,) * len(self.budget.limits)
        return self.disputes.last_prices(now, self.budget.limits)

    def lacking_beside_booked(self, now: float, use: Use) -> tuple[str, ...]:
        """Name the limits that have no room for a contested message beside what is booked and not used yet."""
        return self.budget.lacking(now, use, self.disputes.besides(now, use))

    def weigh_copy(self, now: float, use: Use) -> tuple[str, ...]:
        """Weigh the streams that compete; name the limits without room for a copy beside what is booked for them.

        Else copies for a robot that was away cost the others 21 and 26 of 60 alarms.
        """
        self._advance(now)
        return self.lacking_beside_booked(now, use)

    def lacking_beside_rivals(self, now: float, stream: Stream | None, use: Use) -> tuple[tuple[str, ...], float]:
        """Name the limits that have no room for a sample beside what robots with a better claim may just have sent.

        And until when at least that counts as taken if nothing is heard of them [s].
        """
        budget = self.budget
        if stream is None or budget.alone or not self.view.peers:
            return (), math.inf
        limits = budget.stretch.limits(now, budget.usable(now), use, alone=False)
        taken, until = self.claims.rivals(
            now,
            stream,
            limits,
            partial(grew, budget, limits),
            partial(budget.free, now),
            agreed=budget.coordination.team.agrees,
        )
        if not any(taken):
            return (), until
        return budget.lacking(now, use, self.disputes.besides(now, both(use, taken))), until

    def weigh_ahead(self, now: float) -> None:
        """Weigh the streams that compete if it is time to, so that the next sample need not wait for that."""
        if now >= self.disputes.due_at:
            self._advance(now)

    def _advance(self, now: float, deciding: Stream | None = None) -> None:
        """Weigh anew how streams stand, if it is time to."""
        budget, disputes, before = self.budget, self.disputes, self.disputes.revision
        limits = budget.usable(now)
        rates = partial(sustained, budget)
        disputes.advance(now, limits, alone=budget.alone, turns=budget.turns, deciding=deciding, rates=rates)
        if disputes.revision != before:
            budget.stretch.weigh(limits, disputes.beside, disputes.contested, disputes.sent)
            self.view.traffic.stretch(longest_window(stretched(limits, budget.stretch.planned(limits))))
