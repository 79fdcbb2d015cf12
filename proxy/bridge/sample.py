"""A Zenoh sample on its way across: nothing about it changes, but for what `source_of` says."""

from typing import NamedTuple

import zenoh

from proxy.bridge.air import Air

MAX_STAMP_ERROR = 1.0
"""A timestamp further than this from the arrival says nothing about when the sample was made [s]."""

_PRIORITIES = {
    "Priority.REAL_TIME": 1,
    "Priority.INTERACTIVE_HIGH": 2,
    "Priority.INTERACTIVE_LOW": 3,
    "Priority.DATA_HIGH": 4,
    "Priority.DATA": 5,
    "Priority.DATA_LOW": 6,
    "Priority.BACKGROUND": 7,
}


class Held(NamedTuple):
    """A sample with the timestamp it leaves with. `size` is that of the payload [B]."""

    sample: zenoh.Sample
    stamp: zenoh.Timestamp | None
    key: str
    size: int


def publish(
    session: Air,
    sample: zenoh.Sample,
    stamp: zenoh.Timestamp | None,
    key: str | None = None,
    *,
    droppable: bool = False,
) -> None:
    """Publish `sample` as it is on `session`, to others than the session itself. Raises `zenoh.ZError`.

    `key` is that of the sample unless one is given. A `droppable` sample is dropped where a link is full, even if it
    says that it would wait.
    """
    control = zenoh.CongestionControl.DROP if droppable else sample.congestion_control
    if sample.kind == zenoh.SampleKind.DELETE:
        session.delete(
            key or sample.key_expr,
            congestion_control=control,
            priority=sample.priority,
            express=sample.express,
            attachment=sample.attachment,
            timestamp=stamp,
            allowed_destination=zenoh.Locality.REMOTE,
            source_info=source_of(sample),
        )
        return
    session.put(
        key or sample.key_expr,
        sample.payload,  # the ZBytes itself: bytes() would copy it
        encoding=sample.encoding,
        congestion_control=control,
        priority=sample.priority,
        express=sample.express,
        attachment=sample.attachment,
        timestamp=stamp,
        allowed_destination=zenoh.Locality.REMOTE,
        source_info=source_of(sample),
    )


def source_of(sample: zenoh.Sample) -> zenoh.SourceInfo | None:
    """Return the source info to publish `sample` with: its own, unless its session also stamped it.

    Who numbers and stamps is an advanced publisher with a cache. Its history crosses in replies, which carry stamps but
    no source info: subscribers would take both for different publishers, miss samples and get others twice. By the
    stamps alone they order and tell apart all of them.
    """
    info = sample.source_info
    if info is None:  # almost always
        return None
    stamp = sample.timestamp
    return None if stamp is not None and str(info.source_id.zid) == origin_of(stamp) else info


def heartbeat(key: str, stamp: zenoh.Timestamp | None) -> bool:
    """Whether a sample on an advanced publisher's own key speaks of numbers that `source_of` takes away.

    A subscriber would answer it by fetching what it has, and what the planner dropped.
    """
    _, _, publisher = key.partition("/@adv/pub/")
    return stamp is not None and publisher.split("/")[0] == origin_of(stamp)


def priority_of(sample: zenoh.Sample) -> int:
    """Zenoh's number of the sample's priority: 1 real time … 7 background."""
    return _PRIORITIES[str(sample.priority)]


def wall_of(stamp: zenoh.Timestamp) -> float:
    """Return the wall time inside a timestamp [s since 1970]."""
    return stamp.get_time_as_ntp64().as_secs_f64()


def origin_of(stamp: zenoh.Timestamp) -> str:
    """Return the id inside a timestamp: the session that stamped."""
    return str(stamp.get_id())


def generated(stamp: zenoh.Timestamp | None, now: float, wall: float) -> float:
    """When a sample was made, on the monotonic clock [s]: by its timestamp if that is plausible, else now."""
    if stamp is None:
        return now
    age = wall - wall_of(stamp)
    return now - age if abs(age) <= MAX_STAMP_ERROR else now
