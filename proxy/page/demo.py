"""What a demo lets the page do to its world: set the channel, and put something red into a robot's path.

A demo serves both keys, as queryables within `sendworthy/demo/**`; where nobody does, the page has no buttons for it. A
query without a payload is answered with JSON of what is set now, one with JSON sets it first:

- `sendworthy/demo/channel`: `{"limit": bytes in a second, "latency": seconds, "loss": 0 to 1}`
- `sendworthy/demo/red`: `{"robot": name}`; answered with `{"robots": [names]}`, those that can be given something red.

What cannot be done is answered with an error that says why.
"""

import json
import math
from dataclasses import asdict, dataclass
from typing import Any

from proxy.errors import ProxyError

ALL = "sendworthy/demo/**"
CHANNEL = "sendworthy/demo/channel"
RED = "sendworthy/demo/red"


class DemoOrderError(ProxyError):
    """What a demo is told makes no sense."""


@dataclass(frozen=True, slots=True)
class Channel:
    """A shared medium: its `limit` [B/s], its `latency` [s] and the part of messages that it loses."""

    limit: float
    latency: float = 0.0
    loss: float = 0.0

    @classmethod
    def read(cls, raw: bytes) -> "Channel":
        """Read it. Raises DemoOrderError."""
        told = _object(raw)
        try:
            numbers = [float(told[name]) for name in ("limit", "latency", "loss")]
        except (KeyError, TypeError, ValueError, OverflowError):
            numbers = [math.nan]
        if (
            not all(map(math.isfinite, numbers))
            or numbers[0] <= 0.0
            or numbers[1] < 0.0
            or not 0.0 <= numbers[2] <= 1.0
        ):
            raise DemoOrderError('a channel is {"limit": bytes in a second, "latency": seconds, "loss": 0 to 1}')
        return cls(*numbers)

    def write(self) -> bytes:
        """Return what `read` reads."""
        return json.dumps(asdict(self)).encode()


def red_order(robot: str) -> bytes:
    """Return the order to put something red into a robot's path."""
    return json.dumps({"robot": robot}).encode()


def read_red(raw: bytes) -> str:
    """Return the robot that such an order names. Raises DemoOrderError."""
    robot = _object(raw).get("robot")
    if not isinstance(robot, str) or not robot:
        raise DemoOrderError('something red is ordered with {"robot": name}')
    return robot


def read_robots(raw: bytes) -> list[str]:
    """Return the robots that can be given something red, as a demo answers. Raises DemoOrderError."""
    robots = _object(raw).get("robots")
    if not isinstance(robots, list) or not all(isinstance(each, str) for each in robots):
        raise DemoOrderError('a demo answers with {"robots": [names]}')
    return robots


def _object(raw: bytes) -> dict[str, Any]:
    try:
        told = json.loads(raw)
    except (ValueError, RecursionError):
        told = None
    return told if isinstance(told, dict) else {}
