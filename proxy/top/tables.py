"""The tables of `sendworthy top`: columns with rates, beside those that the status has, too."""

from dataclasses import replace

from proxy.quantities import UNKNOWN, Status, amount, duration
from proxy.status.columns import Column, Table
from proxy.status.tables import PEERS, STREAMS, latency, percent, word
from proxy.top.rates import DROPPED

REASONS = 2
"""So many reasons are named of a stream."""


def per_second(each: Status, name: str) -> str:
    """Write how many there are in a second."""
    value = each.get(name)
    return UNKNOWN if value is None else f"{value:.1f}"


def why(each: Status) -> str:
    """Write for which reasons samples are dropped, most first, and how many in a second."""
    reasons = [f"{reason.removeprefix(DROPPED)} {rate:.2g}" for reason, rate in (each.get("why") or {}).items()]
    return ", ".join([*reasons[:REASONS], *["…"] * (len(reasons) > REASONS)]) or UNKNOWN


def _bytes(each: Status) -> str:
    value = each.get("bytes")
    return UNKNOWN if value is None else f"{amount(value, 'B')}/s"


def _shared(table: Table, *heads: str) -> tuple[Column, ...]:
    return tuple(column for head in heads for column in table.columns if column.head == head)


def _ranked(table: Table, head: str, rank: int) -> Column:
    """Return a column with another rank."""
    (column,) = _shared(table, head)
    return replace(column, rank=rank)


MADE = Column("MADE/S", "samples published in a second", lambda s: per_second(s, "made"), ("generated",))
SENT = Column("SENT/S", "samples sent in a second", lambda s: per_second(s, "sent"), ("forwarded",))
UNSENT = Column("NOT SENT", "samples not sent, in a second", lambda s: per_second(s, "unsent"), ("generated",))
AMOUNT = Column("BYTES", "how much of it is sent in a second", _bytes, ("forwarded", "size"), rank=3)
WHY = Column("DROPPED BECAUSE", "why, and how many in a second", why, ("by_reason",), rank=1, left=True)
LIVE = Table(
    "Streams",
    "The samples of one key from one robot.",
    "streams",
    (
        *_shared(STREAMS, "STREAM"),
        MADE,
        SENT,
        UNSENT,
        *_shared(STREAMS, "AGE"),
        _ranked(STREAMS, "SIZE", 4),
        AMOUNT,
        _ranked(STREAMS, "WANTED BY", 2),
        *_shared(STREAMS, "TYPE"),
        WHY,
    ),
)
FLEET = Table(
    "Robots",
    "Each robot once: by itself where it answers, else as another one sees it.",
    "peers",
    (
        Column("ROBOT", "its name", lambda r: word(r, "robot"), ("robot",), name=True),
        *_shared(PEERS, "MODE", "VERSION"),
        Column("STREAMS", "how many it publishes", lambda r: str(r.get("streams", 0)), (), rank=6),
        replace(MADE, rank=2),
        SENT,
        UNSENT,
        AMOUNT,
        Column(
            "OLDEST", "the age of its stream that is oldest where it is wanted", lambda r: duration(r.get("age")), ()
        ),
        Column("TO IT", "how long small samples take to it", lambda r: latency(r.get("latency_out")), ("latency_out",)),
        Column("LOST TO", "the part of them that is lost", lambda r: percent(r.get("loss_out")), ("loss_out",)),
        _ranked(PEERS, "CLOCK", 1),
        Column(
            "HEARD", "how long ago it told of itself", lambda r: duration(r.get("digest_age")), ("digest_age",), rank=5
        ),
        Column("SEEN BY", "who says so", lambda r: word(r, "seen_by"), (), rank=7),
    ),
)
SORTS = {
    "not sent": "unsent",
    "made": "made",
    "sent": "sent",
    "age": "age",
    "bytes": "bytes",
    "name": "",
}
"""By what rows can be sorted: what it is called, and the field; by name where there is none."""
