"""A Zenoh sample on its way across: nothing about it changes, but that numbers may be taken away."""

from typing import NamedTuple

import zenoh

from proxy.bridge.broadcast import DataSession
from proxy.bridge.tuning import TUNING

_PRIORITIES = {
    "Priority.REAL_TIME": 1,
    "Priority.INTERACTIVE_HIGH": 2,
    "Priority.INTERACTIVE_LOW": 3,
    "Priority.DATA_HIGH": 4,
    "Priority.DATA": 5,
    "Priority.DATA_LOW": 6,
    "Priority.BACKGROUND": 7,
}


class Parcel(NamedTuple):
    """All of a sample that matters for its way on, in memory of its own."""

    key_expr: zenoh.KeyExpr
    payload: zenoh.ZBytes
    kind: zenoh.SampleKind
    encoding: zenoh.Encoding
    congestion_control: zenoh.CongestionControl
    priority: zenoh.Priority
    express: bool
    attachment: zenoh.ZBytes | None


class Held(NamedTuple):
    """A sample with the timestamp and the source info it leaves with, and its `size_of` [B].

    `to` is the tag of the only robot that gets it, if it is a copy.
    """

    sample: zenoh.Sample | Parcel
    stamp: zenoh.Timestamp | None
    key: str
    size: int
    source: zenoh.SourceInfo | None
    to: str = ""

    @property
    def waits(self) -> bool:
        """Whether its publisher would rather wait than lose it."""
        return bool(self.sample.congestion_control != zenoh.CongestionControl.DROP)

    @property
    def shared(self) -> bool:
        """Whether it is in shared memory of its publisher, who lacks that as long as it is held."""
        return self.sample.payload.as_shm() is not None

    @property
    def apart(self) -> "Held":
        """The same, to be held for longer: a small sample takes all the memory that Zenoh received it in."""
        sample = self.sample
        if isinstance(sample, Parcel) or (self.size >= TUNING.small_sample and not self.shared):
            return self
        attachment, encoding = sample.attachment, zenoh.Encoding(str(sample.encoding))
        return self._replace(
            sample=Parcel(
                key_expr=sample.key_expr,
                payload=_copied(sample.payload),
                kind=sample.kind,
                encoding=encoding if encoding == sample.encoding else sample.encoding,  # some have no name
                congestion_control=sample.congestion_control,
                priority=sample.priority,
                express=sample.express,
                attachment=None if attachment is None else _copied(attachment),
            )
        )


def publish(
    session: DataSession,
    sample: zenoh.Sample | Parcel,
    stamp: zenoh.Timestamp | None,
    key: str | None = None,
    *,
    source: zenoh.SourceInfo | None,
    droppable: bool = False,
) -> None:
    """Publish `sample` with `stamp` and `source` on `session`, to others than itself. Raises `zenoh.ZError`.

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
            source_info=source,
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
        source_info=source,
    )


def size_of(sample: zenoh.Sample) -> int:
    """What a sample brings along, payload and attachment [B]: both are on the air, and in memory."""
    attachment = sample.attachment
    return len(sample.payload) if attachment is None else len(sample.payload) + len(attachment)


def priority_of(sample: zenoh.Sample | Parcel) -> int:
    """Zenoh's number of the sample's priority: 1 real time … 7 background."""
    return _PRIORITIES[str(sample.priority)]


def wall_of(stamp: zenoh.Timestamp) -> float:
    """Return the wall time inside a timestamp [s since 1970]."""
    return stamp.get_time_as_ntp64().as_secs_f64()


def origin_of(stamp: zenoh.Timestamp) -> str:
    """Return the id inside a timestamp: the session that stamped."""
    return str(stamp.get_id())


def generated(stamp: zenoh.Timestamp | None, now: float, wall: float) -> float:
    """When a sample was made, on the monotonic clock [s]: by its timestamp if that is plausible, else now.

    A timestamp from the future is not: Zenoh's clock stands still while the wall clock, set back, is behind it, and
    runs ahead with another one that is ahead.
    """
    if stamp is None:
        return now
    age = wall - wall_of(stamp)
    return now - age if 0.0 <= age <= TUNING.stamp_mismatch else now


def _copied(content: zenoh.ZBytes) -> zenoh.ZBytes:
    return zenoh.ZBytes(content.to_bytes())
