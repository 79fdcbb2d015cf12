"""How a query was asked, in the words of Zenoh's interface, which does not tell who receives it."""

from dataclasses import dataclass

import zenoh

from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.wire import Asked

_TARGETS = (zenoh.QueryTarget.BEST_MATCHING, zenoh.QueryTarget.ALL, zenoh.QueryTarget.ALL_COMPLETE)
_PRIORITIES = (
    zenoh.Priority.DATA,  # 0 is Zenoh's own, for what controls links
    zenoh.Priority.REAL_TIME,
    zenoh.Priority.INTERACTIVE_HIGH,
    zenoh.Priority.INTERACTIVE_LOW,
    zenoh.Priority.DATA_HIGH,
    zenoh.Priority.DATA,
    zenoh.Priority.DATA_LOW,
    zenoh.Priority.BACKGROUND,
)
_PRIORITY, _WAITS, _EXPRESS = 0x07, 0x08, 0x10
"""Bits of the quality of service on the wire."""


@dataclass(frozen=True, slots=True)
class QueryOptions:
    """How to ask a query on. `timeout` is in [s]; of what is None Zenoh has a default."""

    target: zenoh.QueryTarget
    timeout: float
    priority: zenoh.Priority | None = None
    congestion_control: zenoh.CongestionControl | None = None
    express: bool | None = None

    @property
    def complete(self) -> bool:
        """Whether the query reaches only queryables that are complete."""
        return bool(self.target == zenoh.QueryTarget.ALL_COMPLETE)


def options_of(asked: Asked | None) -> QueryOptions:
    """Return how a query was asked, from what was read of it; None: nothing was, so everybody is asked, patiently."""
    if asked is None:
        return QueryOptions(zenoh.QueryTarget.ALL, TUNING.default_query_timeout)
    return QueryOptions(
        target=_TARGETS[asked.target] if asked.target < len(_TARGETS) else zenoh.QueryTarget.ALL,
        timeout=TUNING.default_query_timeout if asked.timeout is None else asked.timeout,
        priority=_PRIORITIES[asked.qos & _PRIORITY],
        congestion_control=zenoh.CongestionControl.BLOCK if asked.qos & _WAITS else zenoh.CongestionControl.DROP,
        express=bool(asked.qos & _EXPRESS),
    )
