"""The limits in force: those of the specs, of which adaptive ones follow what the channel bears."""

import math

from proxy.core.congestion.capacity import Capacity
from proxy.core.congestion.control import Traffic
from proxy.core.interface.commands import SetPace
from proxy.core.model.limits import Limit, in_force, use_of
from proxy.core.protocol.messages import tag
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Channel:
    """The limits of the specs as ceilings, and what is in force of them."""

    def __init__(self, now: float, view: SharedView) -> None:
        self.capacity = Capacity(now, tag(view.settings.zid))
        self.limits: tuple[Limit, ...] = ()
        self.staleness = 0.0
        """How long news of others wait on a channel that is full [s]."""
        self._view = view
        self._ceilings: tuple[Limit, ...] = ()
        self._adaptive: tuple[Limit, ...] = ()
        self._factors: tuple[float, ...] | None = ()
        """Those of which the driver knows."""

    @property
    def due_at(self) -> float:
        """When to look at it, and to put in force what it bears [s]."""
        return -math.inf if self._factors != self.capacity.factors else self.capacity.due_at

    @property
    def allowance_factor(self) -> float:
        """How much of the allowance is left: less than in proportion, as digests tell where little gets through."""
        return math.sqrt(min(self.capacity.factors, default=1.0))

    def adopt(self, now: float, limits: tuple[Limit, ...]) -> None:
        """The limits are now these; adaptive ones begin where those of the same name are."""
        self._ceilings, self._adaptive = limits, tuple(limit for limit in limits if limit.least < 1.0)
        self.capacity.set_limits(now, limits)
        if self._factors or self.capacity.factors:
            self._factors = None  # so that the driver is told
        self.limits = in_force(limits, self.capacity.factors)
        self.staleness = 0.0  # until the next look: without adaptive limits there is none

    def look(self, now: float, dropped: int) -> bool:
        """Look at the channel, `dropped` samples of ours so far, if it is time to; whether all should hear at once."""
        if now < self.capacity.due_at:
            return False
        self.capacity.evidence.sent(now, self._view.traffic.messages, self._view.traffic.bytes)
        self.capacity.look(now, self._traffic(now, dropped))
        self.staleness = self.capacity.staleness(now)
        return self.capacity.has_news(now)

    def apply(self) -> SetPace | None:
        """Put in force what the channel bears; return the pace for the mesh when other limits are in force."""
        if self.capacity.factors == self._factors:
            return None
        self._factors = self.capacity.factors
        self.limits = in_force(self._ceilings, self._factors)
        if not self._factors:
            return SetPace(math.inf)
        pairs = zip(self.limits, self._ceilings, strict=True)
        return SetPace(min(limit.measure.pace * limit.limit / ceiling.limit for limit, ceiling in pairs))

    def _traffic(self, now: float, dropped: int) -> Traffic:
        streams = self._view.contention.all(now)
        own = self._view.settings.robot
        receivers = {name for s in streams if s.robot == own for name in self._view.subscribers.of(s)}
        others = (stream for stream in self._view.streams if stream.robot != own)
        parts = [self._parts(stream) for stream in streams]
        windows = [limit.window / part for limit, part in zip(self._adaptive, self.capacity.factors, strict=True)]
        return Traffic(
            dropped=dropped + sum(stream.generated - stream.forwarded for stream in others),
            receivers=receivers,
            longest=max((part * time for each in parts for part, time in zip(each, windows, strict=True)), default=0.0),
            each=tuple(sum(each[k] for each in parts) for k in range(len(windows))),
            one=tuple(max((each[k] for each in parts), default=0.0) for k in range(len(windows))),
            leader=self._leader(),
        )

    def _leader(self) -> str:
        """Whose report on the channel counts: of all that take part the robot with the least tag."""
        present = (name for name, peer in self._view.peers.items() if not peer.plain)
        return min((tag(self._view.settings.zid), *present))

    def _parts(self, stream: Stream) -> tuple[float, ...]:
        """What a sample takes of the ceilings of adaptive limits."""
        uses = use_of(stream.newest.size, self._view.subscribers.copies(stream), self._adaptive, own=False)
        return tuple(use / limit.limit for use, limit in zip(uses, self._adaptive, strict=True))
