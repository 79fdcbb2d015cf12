"""What somebody asks to be profiled, and what is refused."""

import json
from dataclasses import asdict, dataclass

from proxy.errors import ProxyError

END = b"end"
"""Asks for the end of the profile that is being taken, and for what it saw until then."""
SECONDS = (0.1, 60.0)
"""How long a profile may take [s]."""
RATE = (1.0, 1000.0)
"""How often a thread may look at itself in a second that it runs; the kernel has it do so once a tick at most [1/s]."""


class ProfileError(ProxyError):
    """A profile cannot be taken: what was asked for, or when."""


@dataclass(frozen=True, slots=True)
class Request:
    """A profile of so many `seconds`, with so many looks in each that a thread runs.

    Raises ProfileError for too much of either.
    """

    seconds: float = 10.0
    rate: float = 1000.0

    def __post_init__(self) -> None:
        for name, value, (least, most) in (("seconds", self.seconds, SECONDS), ("rate", self.rate, RATE)):
            if not least <= value <= most:
                raise ProfileError(f"{name} must be from {least:g} to {most:g}, not {value:g}")

    def write(self) -> bytes:
        """Return what `read` reads."""
        return json.dumps(asdict(self)).encode()


def read(raw: bytes) -> Request:
    """Read a request; what is not said is as usual. Raises ProfileError."""
    try:
        return Request(**{name: float(value) for name, value in json.loads(raw or b"{}").items()})
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        raise ProfileError('a profile is asked for with {"seconds": 10, "rate": 1000}') from None
