"""Hands what arrives from the mesh to the apps: in full, each sample once, at once but for what `hold_back` keeps."""

from collections.abc import Callable, Collection, Mapping
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.attached import attach
from proxy.bridge.barrier import Barrier
from proxy.bridge.declaration import Declaration
from proxy.bridge.deduplication import Deduplication, of_sample
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.mirror import Mirror
from proxy.bridge.received import Received
from proxy.bridge.rules import Rules, Verdict
from proxy.bridge.sample import Held, origin_of, publish, size_of, wall_of
from proxy.bridge.tuning import TUNING
from proxy.core.interface.events import Event, SampleHeard
from proxy.core.protocol.messages import tag


class Delivery:
    """Subscribes on the mesh to exactly what the apps subscribe to.

    In broadcast these subscriptions tell the others what is wanted, and hear who does not broadcast; samples come by
    `overhear`. Nobody publishes a sample both ways.

    `covered` says whether an information type covers a key; for such samples `offer` gets a `SampleHeard`. `numbered`:
    samples keep the numbers of their publishers. `counts_each`: each sample of a key counts, so that other robots keep
    copies for us while we are away, and what is new waits in `hold_back` for these. What `barrier` holds goes when that
    lets it.
    """

    def __init__(
        self,
        app: zenoh.Session,
        mesh: zenoh.Session,
        covered: Callable[[str], object | None],
        rules: Rules,
        offer: Callable[[Event], object],
        *,
        numbered: bool = True,
        counts_each: Callable[[str], bool] = lambda _: False,
        hold_back: HoldBack | None = None,
        barrier: Barrier | None = None,
    ) -> None:
        self._app = app
        self._mesh = mesh
        self._covered = covered
        self._rules = rules
        self._offer = offer
        self._numbered = numbered
        self._counts_each = counts_each
        self._received = Received()
        self.hold_back = HoldBack(lambda _: "") if hold_back is None else hold_back
        self._barrier = barrier
        self._copies: Declaration | None = None
        self._deduplication = Deduplication(of_sample)
        self._mirror = Mirror(self._subscribe, TUNING.grace)
        self.delivered = 0
        self.repeated = 0
        """Copies of samples that had come before."""

    def open(self) -> None:
        """Hear the copies of samples that were kept for us."""
        handler = zenoh.handlers.Callback(self._deliver_copy, indirect=False)
        ours = keys.kept(tag(str(self._mesh.zid())), "*/**")
        self._copies = self._mesh.declare_subscriber(ours, handler, allowed_origin=zenoh.Locality.REMOTE)

    @property
    def expressions(self) -> tuple[str, ...]:
        """What we subscribe to on the mesh for the apps."""
        return self._mirror.expressions

    @property
    def declared(self) -> Collection[str]:
        """The same, as it is."""
        return self._mirror.declared

    @property
    def leaving(self) -> bool:
        """Whether something waits to be taken back: `update` has to be called again."""
        return self._mirror.leaving

    def update(self, wanted: Mapping[str, bool]) -> bool:
        """Subscribe to exactly `wanted`, as the apps do now; return whether that is news."""
        return self._mirror.update(wanted)

    def close(self) -> None:
        """Subscribe to nothing, and hand on what is held back."""
        self._mirror.close()
        self.hold_back.close()
        copies, self._copies = self._copies, None
        if copies is not None:
            copies.undeclare()

    def overhear(self, key: str, sample: zenoh.Sample) -> None:
        """Take in a sample of `key` that was broadcast, wanted or not: the core learns of all that are covered."""
        if self._deduplication.covers(key):
            self._hand(key, sample, key)
        elif self._covered(key) is not None:
            self._offer(_heard(key, sample))

    def _subscribe(self, expression: str, _complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        subscribe = partial(self._mesh.declare_subscriber, expression, allowed_origin=zenoh.Locality.REMOTE)
        return self._deduplication.declare(expression, self._deliver, subscribe)

    def _deliver(self, number: int, sample: zenoh.Sample) -> None:
        attach()
        key = str(sample.key_expr)
        if self._deduplication.takes(number, key, sample):
            self._hand(key, sample)

    def _deliver_copy(self, sample: zenoh.Sample) -> None:
        attach()
        key = keys.kept_of(str(sample.key_expr))
        if key and self._deduplication.covers(key):
            self._hand(key, sample, key, copy=True)

    def _hand(self, key: str, sample: zenoh.Sample, renamed: str | None = None, *, copy: bool = False) -> None:
        verdict, stamp = self._rules.into.verdict(key), sample.timestamp
        ordered = copy or self._counts_each(key)
        if copy:
            self.hold_back.copied(key, stamp)
        if ordered and not self._received.takes(key, stamp, copy=copy):
            self.repeated += 1
            return
        if verdict is Verdict.COMPANION and not self._numbered:
            return
        if verdict is Verdict.DENIED:
            self._rules.into.count("samples")  # it was on the air all the same
        else:
            held = Held(sample, stamp, key, size_of(sample), sample.source_info if self._numbered else None)
            may_wait = ordered and not copy
            hand = partial(self._let, held.apart if may_wait and self.hold_back.waits else held, renamed)
            if not (may_wait and self.hold_back.takes(key, stamp, held.size, hand)):
                hand()
        if not copy and self._covered(key) is not None:  # how long a copy took says nothing about the way
            self._offer(_heard(key, sample))

    def _let(self, held: Held, renamed: str | None) -> None:
        """Publish a sample when the apps know of what was declared before it."""
        barrier, now, key = self._barrier, clock.monotonic(), held.key
        quiet = None if barrier is None else barrier.holds(key, now, ordered=self._covered(key) is None)
        if barrier is None or quiet is None:
            self._publish(held, renamed)
        else:
            barrier.hold(key, now, held.size, partial(self._publish, held, renamed), quiet=quiet)

    def _publish(self, held: Held, renamed: str | None) -> None:
        publish(self._app, held.sample, held.stamp, renamed, source=held.source)
        self.delivered += 1


def _heard(key: str, sample: zenoh.Sample) -> SampleHeard:
    stamp = sample.timestamp
    return SampleHeard(
        now=clock.monotonic(),
        key=key,
        size=size_of(sample),
        origin=None if stamp is None else origin_of(stamp),
        stamp=None if stamp is None else wall_of(stamp),
        # The sender's digest carries their worth; decoding every frame again would cost a core.
        features=None,
    )
