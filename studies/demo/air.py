"""What the shared medium is like at the moment: how much it carries, how long that takes, and what is lost."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

KEYS = "limit", "latency", "loss"
LEAST, MOST = 1_000.0, 1e9
"""What a medium may carry [B/s]."""
LONGEST = 5.0
"""Latency at most [s]."""


class AirError(ValueError):
    """A medium cannot be like that; says which key is wrong."""


@dataclass(frozen=True, slots=True)
class Air:
    """`limit` is what the medium carries [B/s], `latency` how long each byte is under way [s].

    `loss` is the probability with which a packet is lost and has to be sent anew, as TCP does.
    """

    limit: float
    latency: float = 0.0
    loss: float = 0.0

    def changed(self, wanted: object) -> Self:
        """Return the medium with some keys changed. Raises AirError."""
        if not isinstance(wanted, Mapping):
            raise AirError(f"a channel is changed with a JSON object of {', '.join(KEYS)}, not with {wanted!r:.60}")
        for key, value in wanted.items():
            if key not in KEYS:
                raise AirError(f"{key}: unknown; a channel has {', '.join(KEYS)}")
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise AirError(f"{key}: {value!r:.60} is not a number")
            low, high, unit = _RANGES[key]
            if not low <= value <= high:
                raise AirError(f"{key}: {value:g} is not from {low:g} to {high:g}{unit}")
        return replace(self, **{key: float(value) for key, value in wanted.items()})

    def to_json(self) -> str:
        """Return it as JSON."""
        return json.dumps(asdict(self))


_RANGES: dict[str, tuple[float, float, str]] = {
    "limit": (LEAST, MOST, " bytes a second"),
    "latency": (0.0, LONGEST, " s"),
    "loss": (0.0, 1.0, ""),
}


def read_json(raw: bytes) -> Any:
    """Read a payload. Raises AirError for what is no JSON."""
    try:
        return json.loads(raw)
    except ValueError as error:
        raise AirError(f"not JSON: {error}") from None
