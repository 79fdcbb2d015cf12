"""A sample as features see it: its key, its payload and attachment, and what is decoded of them, each once."""

from collections.abc import Callable, Hashable
from functools import cached_property
from typing import Any, Protocol, TypeVar

from utility_specs.errors import FeatureError

Made = TypeVar("Made")


class Payload(Protocol):
    """A payload that copies itself only when asked, like `zenoh.ZBytes`."""

    def to_bytes(self) -> bytes:
        """Return the payload."""


AnyPayload = bytes | bytearray | memoryview | Payload


class Sample:
    """What features are computed from. Payload and attachment are copied when a feature first reads them."""

    def __init__(self, key: str, payload: AnyPayload, attachment: AnyPayload | None = None) -> None:
        self.key = key
        self._payload = payload
        self._attachment = attachment
        self._made: dict[Hashable, tuple[Any, str | None]] = {}

    @cached_property
    def payload(self) -> bytes:
        """The payload."""
        return _bytes(self._payload)

    @cached_property
    def attachment(self) -> bytes:
        """The attachment; raises FeatureError when the sample has none."""
        if self._attachment is None:
            raise FeatureError(f"{self.key}: the sample has no attachment")
        return _bytes(self._attachment)

    def once(self, what: Hashable, make: Callable[[], Made]) -> Made:
        """Return what `make` returns, made once for all features that ask for `what`.

        Where it fails it is not tried again: raises FeatureError each time.
        """
        if what not in self._made:
            try:
                self._made[what] = make(), None
            except Exception as error:  # noqa: BLE001 - payloads are broken in every way; only the words are kept
                self._made[what] = None, f"{type(error).__name__}: {error}"
        made, failure = self._made[what]
        if failure is not None:
            raise FeatureError(f"{self.key}: {failure}")
        return made  # type: ignore[no-any-return] # `what` stands for one type


def _bytes(payload: AnyPayload) -> bytes:
    return bytes(payload) if isinstance(payload, bytes | bytearray | memoryview) else payload.to_bytes()
