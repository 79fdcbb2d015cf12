"""Hands what arrives from the mesh to the apps: at once, in full, each sample once."""

from collections.abc import Callable, Mapping
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge.air import Air
from proxy.bridge.declaration import Declaration
from proxy.bridge.mirror import Mirror
from proxy.bridge.owners import Owners
from proxy.bridge.sample import origin_of, publish, wall_of
from proxy.core.events import Event, SampleHeard


class Delivery:
    """Subscribes on the mesh to exactly what the apps subscribe to.

    In broadcast samples come by `air`. The subscriptions on the mesh then say what is wanted, and hear who does not
    broadcast. Nobody publishes a sample on both.

    `covered` says whether an information type covers a key; for such samples `post` gets a `SampleHeard`.
    """

    def __init__(
        self,
        app: zenoh.Session,
        mesh: zenoh.Session,
        air: Air,
        covered: Callable[[str], object | None],
        post: Callable[[Event], None],
    ) -> None:
        self._app = app
        self._sessions: tuple[Air, ...] = (mesh,) if air is mesh else (air, mesh)
        self._covered = covered
        self._post = post
        self._owners = Owners()
        self._mirror = Mirror(self._subscribe, self._owners.discard)
        self.delivered = 0

    @property
    def expressions(self) -> tuple[str, ...]:
        """What we subscribe to on the mesh for the apps."""
        return self._mirror.expressions

    def update(self, wanted: Mapping[str, bool]) -> bool:
        """Subscribe to exactly `wanted`, as the apps do now; return whether that is news."""
        return self._mirror.update(wanted)

    def wants(self, key: str) -> bool:
        """Whether an app subscribes to `key`."""
        return self._owners.owner(key) is not None

    def close(self) -> None:
        """Subscribe to nothing."""
        self._mirror.close()

    def _subscribe(self, expression: str, _complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        self._owners.add(expression)
        handler = zenoh.handlers.Callback(partial(self._deliver, expression), indirect=False)
        remote = zenoh.Locality.REMOTE
        return _All([each.declare_subscriber(expression, handler, allowed_origin=remote) for each in self._sessions])

    def _deliver(self, expression: str, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if self._owners.owner(key) != expression:
            return
        stamp = sample.timestamp
        publish(self._app, sample, stamp)
        self.delivered += 1
        if self._covered(key) is not None:
            self._post(heard(sample, key))


class _All:
    """Declarations that are taken back together."""

    def __init__(self, declarations: list[Declaration]) -> None:
        self._declarations = declarations

    def undeclare(self) -> None:
        for declaration in self._declarations:
            declaration.undeclare()


def heard(sample: zenoh.Sample, key: str) -> SampleHeard:
    """Tell the core of a sample that came from the mesh now."""
    stamp = sample.timestamp
    return SampleHeard(
        now=clock.monotonic(),
        key=key,
        size=len(sample.payload),
        origin=None if stamp is None else origin_of(stamp),
        stamp=None if stamp is None else wall_of(stamp),
        # The sender's digest carries their worth; decoding every frame again would cost a core.
        features=None,
    )
