"""What the core is told once, at start."""

import math
from dataclasses import dataclass
from typing import Literal

from proxy.core.model.mode import Mode

UNICAST = "unicast"
"""A sample is sent once to each robot that wants it; else `broadcast` and the group: others do not hear each other."""
_BROADCAST = "broadcast"


def broadcast(group: str) -> str:
    """Name the transport that sends a sample once, to all on a multicast group."""
    return f"{_BROADCAST} {group}"


def is_broadcast(transport: str) -> bool:
    """Whether one transmission reaches all."""
    return transport.startswith(_BROADCAST)


@dataclass(frozen=True, slots=True)
class CoreSettings:
    """Settings of one robot's core.

    `horizon` counts contested messages, `horizon_time`, `settle` and `deadline`, from the event that asked on, are
    seconds.

    `allowance` is the share of every limit that all digests may use (at least 100 B/s per robot), `floor` the part that
    a newcomer may use unknown, `margin` what all who plan for all leave (nothing: 5 to 15 % cost 2 to 6 % of utility).
    `inbox`, `inbox_bytes` and, of a stream where each counts, `backlog` bound the samples that wait. `relayed`: robots
    meet at a router. `digests_on_air`: digests are broadcast. `away`: how long samples are kept for a robot that
    vanished [s]; 0: not.
    """

    robot: str
    zid: str
    mode: Mode = Mode.ENFORCE
    horizon: int = 120
    horizon_time: float = 60.0
    iterations: int = 300
    deadline: float = math.inf
    coordination: Literal["announce", "split"] = "announce"
    transport: str = UNICAST
    allowance: float = 0.02
    floor: float = 0.01
    margin: float = 0.0
    settle: float = 0.5
    inbox: int = 256
    inbox_bytes: float = math.inf
    backlog: int = 32
    streams: int = 4096
    relayed: bool = False
    digests_on_air: bool = False
    wall_offset: float = 0.0
    version: str = ""
    away: float = 0.0
