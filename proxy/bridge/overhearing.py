"""Hears on the air what the specs cover, also when no app of this robot wants it: the radio carries it anyway."""

from collections.abc import Callable
from functools import partial

import zenoh

from proxy.bridge.air import Broadcast
from proxy.bridge.declaration import Declaration
from proxy.bridge.delivery import heard
from proxy.bridge.keys import crosses
from proxy.bridge.mirror import Mirror
from proxy.bridge.owners import Owners
from proxy.core.events import SampleHeard
from utility_specs import Specs


class Overhearing:
    """Subscribes to the keys of the specs; `post` gets a `SampleHeard` for what is not `delivered` to an app anyway."""

    def __init__(self, air: Broadcast, delivered: Callable[[str], bool], post: Callable[[SampleHeard], None]) -> None:
        self._air = air
        self._delivered = delivered
        self._post = post
        self._owners = Owners()
        self._mirror = Mirror(self._subscribe, self._owners.discard)

    def update(self, specs: Specs) -> None:
        """Hear what `specs` cover, and nothing else. Nothing of Sendworthy's own is ever heard on the air."""
        keys = (key for information_type in specs.types for key in information_type.keys)
        self._mirror.update({key: False for key in keys if crosses(key)})

    def close(self) -> None:
        """Hear nothing more."""
        self._mirror.close()

    def _subscribe(self, expression: str, _complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        self._owners.add(expression)
        handler = zenoh.handlers.Callback(partial(self._hear, expression), indirect=False)
        return self._air.declare_subscriber(expression, handler, allowed_origin=zenoh.Locality.REMOTE)

    def _hear(self, expression: str, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if self._owners.owner(key) == expression and not self._delivered(key):
            self._post(heard(sample, key))
