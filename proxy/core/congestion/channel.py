"""The limits in force: those of the specs, of which adaptive ones follow what the channel bears."""

import math

from proxy.core.congestion.capacity import Capacity, Seen
from proxy.core.coordination.budget import Budget
from proxy.core.interface.commands import SetPace
from proxy.core.model.limits import Limit, in_force, use_of
from proxy.core.protocol.messages import tag
from proxy.core.samples.counts import Counts
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Channel:
    """Keeps the limits of the `budget`."""

    def __init__(self, now: float, view: SharedView, budget: Budget, counts: Counts) -> None:
        self.capacity = Capacity(now, tag(view.settings.zid))
        self._view = view
        self._budget = budget
        self._counts = counts
        self._ceilings: tuple[Limit, ...] = ()
        self._factors: tuple[float, ...] | None = ()
        self.waiting = 0.0
        """How long news of others wait on a channel that is full [s]."""

    @property
    def part(self) -> float:
        """How much of the allowance is left: less than in proportion, for where little gets through digests tell."""
        return math.sqrt(min(self.capacity.factors, default=1.0))

    def adopt(self, now: float, limits: tuple[Limit, ...]) -> None:
        """The limits are now these; adaptive ones begin where those of the same name are."""
        self._ceilings = limits
        self.capacity.set_limits(now, limits)
        if self._factors or self.capacity.factors:
            self._factors = None  # so that the driver is told
        self._force(self.capacity.factors)
        self.waiting = 0.0  # until it is looked at again: without adaptive limits never

    def look(self, now: float) -> bool:
        """Look at the channel when it is time to; return whether all should hear of it at once."""
        if not self.capacity.due(now):
            return False
        self.capacity.sent(now, self._view.messages, self._view.bytes)
        self.capacity.look(now, self._seen(now))
        self.waiting = self.capacity.waiting(now)
        return self.capacity.news(now)

    def follow(self) -> SetPace | None:
        """Put in force what the channel bears; return the pace for the mesh when that is news."""
        if self.capacity.factors == self._factors:
            return None
        self._factors = self.capacity.factors
        self._force(self._factors)
        if not self._factors:
            return SetPace(math.inf)
        pairs = zip(self._budget.limits, self._ceilings, strict=True)
        return SetPace(min(limit.measure.pace * limit.limit / ceiling.limit for limit, ceiling in pairs))

    def _force(self, factors: tuple[float, ...]) -> None:
        self._budget.set_limits(in_force(self._ceilings, factors))

    def _seen(self, now: float) -> Seen:
        streams = self._view.competition.all(now)
        own = self._view.settings.robot
        wanting = (self._view.wanting(stream) for stream in streams if stream.robot == own)
        others = (stream for stream in self._view.streams() if stream.robot != own)
        factors = self.capacity.factors
        parts = [self._parts(stream) for stream in streams]
        windows = [limit.window / factor for limit, factor in zip(self._adaptive(), factors, strict=True)]
        return Seen(
            dropped=self._counts.dropped + sum(stream.generated - stream.forwarded for stream in others),
            receivers={name for names in wanting for name in names},
            longest=max((part * time for each in parts for part, time in zip(each, windows, strict=True)), default=0.0),
            each=tuple(sum(each[k] for each in parts) for k in range(len(factors))),
            one=tuple(max((each[k] for each in parts), default=0.0) for k in range(len(factors))),
            leader=self._leader(),
        )

    def _leader(self) -> str:
        """Whose word on the channel counts: of all that take part the robot with the least tag."""
        present = (name for name, peer in self._view.peers.items() if not peer.plain)
        return min((tag(self._view.settings.zid), *present))

    def _parts(self, stream: Stream) -> tuple[float, ...]:
        """What a sample takes of the ceilings of adaptive limits."""
        adaptive = self._adaptive()
        uses = use_of(stream.newest.size, self._view.copies(stream), adaptive, own=False)
        return tuple(use / limit.limit for use, limit in zip(uses, adaptive, strict=True))

    def _adaptive(self) -> tuple[Limit, ...]:
        return tuple(limit for limit in self._ceilings if limit.least < 1.0)
