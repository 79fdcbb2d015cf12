"""What the core is told once, at start."""

import math
from dataclasses import dataclass
from typing import Literal

from proxy.core.model.mode import Mode
from proxy.core.model.transport import UNICAST


@dataclass(frozen=True, slots=True)
class CoreSettings:
    """Settings of one robot's core.

    `horizon` counts contested messages, `horizon_time` and `settle` are seconds, `allowance` is the share of every
    limit that all digests together may use (at least 100 B/s per robot), `floor` the part of a limit that a newcomer
    may use before all others know of it, `margin` what all who plan for all leave of every shared limit (nothing: 5 to
    15 % cost 2 to 6 % of utility), `inbox` the samples that may wait for a decision and `inbox_bytes` their size,
    `backlog` those of one stream where each sample counts, `transport` how samples travel (`transport.py`),
    `relayed` says that robots meet at a router: a sample goes on the air to it, and then once to each robot that wants
    it. `digests_on_air` says that digests are broadcast, as samples are. A decision may take `deadline` [s] from the
    event that asked for it on; windows are thinned where it would not do. `version` is that of
    Sendworthy. `away` is how long samples of which each counts are kept for a robot that has vanished [s]; 0.0: the
    driver cannot keep them.
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
