"""The tables of the status: which columns they have, what each means, and how it is written."""

from collections.abc import Iterable

from proxy.quantities import UNKNOWN, Status, amount, duration, number, rate, schedule, share
from proxy.status.columns import Column, Table


def word(each: Status, name: str) -> str:
    """Write a word, or that it is not known."""
    return str(each.get(name) or UNKNOWN)


def count(each: Status, name: str) -> str:
    """Write how many there are."""
    return str(each.get(name, 0))


def percent(part: float | None) -> str:
    """Write a part of one."""
    return UNKNOWN if part is None else f"{part:.1%}"


def latency(line: Status | None) -> str:
    """Write what a small sample takes."""
    return UNKNOWN if line is None else duration(line.get("fixed"))


def per_kilobyte(line: Status | None) -> str:
    """Write what a thousand bytes more take."""
    return UNKNOWN if line is None else duration(1e3 * (line.get("per_byte") or 0.0))


def unsent(stream: Status) -> int:
    """Return how many samples of a stream were not sent."""
    return int(stream.get("generated", 0) - stream.get("forwarded", 0))


LIMITS = Table(
    "Limits",
    "What the channel, or a robot, may be burdened with, as the specs say.",
    "budget",
    (
        Column("LIMIT", "the limit", lambda c: word(c, "constraint"), ("constraint",), name=True),
        Column("IN ANY", "in any window of this length it holds", lambda c: f"{c.get('window', 0.0):g} s", ("window",)),
        Column(
            "ALLOWED",
            "what all robots may use together in a window",
            lambda c: amount(c.get("limit"), c.get("unit", "B")),
            ("limit", "unit"),
        ),
        Column(
            "USED BY ALL",
            "what all robots used in the window that ends now, as far as this one knows",
            lambda c: amount(c.get("used_by_all"), c.get("unit", "B")),
            ("used_by_all",),
            rank=1,
        ),
        Column(
            "OF IT",
            "how much of what is allowed that is",
            lambda c: share(c.get("used_by_all"), c.get("limit")),
            ("used_by_all",),
        ),
        Column(
            "WE MAY",
            "what this robot may use: all in coordination announce, its part in split",
            lambda c: amount(c.get("held"), c.get("unit", "B")),
            ("held",),
            rank=3,
        ),
        Column(
            "WE USED",
            "what this robot used in the window that ends now",
            lambda c: amount(c.get("used"), c.get("unit", "B")),
            ("used",),
            rank=2,
        ),
        Column(
            "1 kB COSTS",
            "what the room for 1000 bytes is worth now [utility·s]: a sample that earns less is not sent; "
            "0 while there is room for all",
            lambda c: number(c.get("price_per_kb")),
            ("price_per_kb",),
        ),
        Column("ROBOTS", "how many robots share it", lambda c: str(c.get("members", 1)), ("members",), rank=4),
    ),
)
STREAMS = Table(
    "Streams",
    "The samples of one key from one robot, of all robots that this one knows.",
    "streams",
    (
        Column("STREAM", "its key", lambda s: word(s, "key"), ("key",), name=True),
        Column("ROBOT", "the robot that publishes it", lambda s: word(s, "robot"), ("robot",), rank=3, left=True),
        Column("TYPE", "the information type of the specs", lambda s: word(s, "type"), ("type",), rank=8, left=True),
        Column(
            "RHYTHM",
            "how its samples come, and how evenly",
            schedule,
            ("schedule", "jitter", "over"),
            rank=7,
            left=True,
        ),
        Column(
            "EVERY", "the time between two samples", lambda s: duration(s.get("period") or None), ("period",), rank=5
        ),
        Column("SIZE", "the size of the last sample", lambda s: amount(s.get("size"), "B"), ("size",), rank=2),
        Column(
            "VALUE",
            "by how much the last sample was worth more than the utility of its type says",
            lambda s: f"{s.get('scale', 0.0):.3g}",
            ("scale",),
            rank=6,
        ),
        Column("MADE", "samples that were published", lambda s: count(s, "generated"), ("generated",)),
        Column("SENT", "those that were sent", lambda s: count(s, "forwarded"), ("forwarded",)),
        Column("NOT SENT", "those that were not", lambda s: str(unsent(s)), ("generated", "forwarded"), rank=1),
        Column("SENT/S", "samples sent in a second, in the mean", rate, ("forwarded", "period"), rank=4),
        Column(
            "AGE",
            "how old the newest sample is that has arrived where it is wanted, by estimates",
            lambda s: duration(s.get("age")),
            ("age", "latency"),
        ),
        Column("WANTED BY", "how many robots want it", lambda s: count(s, "receivers"), ("receivers",)),
    ),
)
PEERS = Table(
    "Other robots",
    "Those on the mesh that run Sendworthy.",
    "peers",
    (
        Column("PEER", "its name", lambda p: word(p, "robot"), ("robot",), name=True),
        Column(
            "MODE",
            "what it does with decisions; or that it takes no part",
            lambda p: word(p, "mode") if p.get("takes_part", True) else "takes no part",
            ("mode", "takes_part"),
            left=True,
        ),
        Column("VERSION", "the Sendworthy that it runs", lambda p: word(p, "version"), ("version",), left=True),
        Column(
            "FROM IT",
            "how long a small sample of it takes to here",
            lambda p: latency(p.get("latency_in")),
            ("latency_in",),
            rank=2,
        ),
        Column(
            "FROM IT/kB",
            "how much longer for every 1000 bytes",
            lambda p: per_kilobyte(p.get("latency_in")),
            ("latency_in",),
            rank=6,
        ),
        Column(
            "TO IT",
            "how long a small sample of ours takes to it",
            lambda p: latency(p.get("latency_out")),
            ("latency_out",),
        ),
        Column(
            "TO IT/kB",
            "how much longer for every 1000 bytes",
            lambda p: per_kilobyte(p.get("latency_out")),
            ("latency_out",),
            rank=5,
        ),
        Column(
            "LOST FROM",
            "the part of its samples that is lost",
            lambda p: percent(p.get("loss_in")),
            ("loss_in",),
            rank=2,
        ),
        Column("LOST TO", "the part of ours that is lost", lambda p: percent(p.get("loss_out")), ("loss_out",)),
        Column(
            "CLOCK",
            "by how much its wall clock is ahead of ours",
            lambda p: duration(p.get("wall_ahead")),
            ("wall_ahead",),
        ),
        Column(
            "HEARD",
            "how long ago it last told of itself",
            lambda p: duration(p.get("digest_age")),
            ("digest_age",),
        ),
        Column("GOT", "samples of it that came here", lambda p: count(p, "samples"), ("samples",), rank=3),
        Column(
            "GOT OURS",
            "samples of ours that it got",
            lambda p: count(p, "received_of_ours"),
            ("received_of_ours",),
            rank=4,
        ),
    ),
)
KEPT = Table(
    "Copies for robots that are away",
    "Of streams of which each sample counts; shown while there are any.",
    "kept.for",
    (
        Column("KEPT FOR", "the robot", lambda k: word(k, "robot"), ("robot",), name=True),
        Column(
            "IT IS",
            "away, or back and getting them",
            lambda k: "back" if k.get("back") else "away",
            ("back",),
            left=True,
        ),
        Column("SINCE", "how long ago it was lost", lambda k: duration(k.get("away")), ("away",)),
        Column("COPIES", "how many wait for it", lambda k: count(k, "samples"), ("samples",)),
    ),
)
FEATURES = Table(
    "Features that do not go well",
    "What could not be computed from samples, or not from each; shown while there are any.",
    "features",
    (
        Column("FEATURE", "the feature", lambda f: word(f, "feature"), ("feature",), name=True),
        Column("TYPE", "the information type", lambda f: word(f, "type"), ("type",), left=True),
        Column(
            "FAILED",
            "how often it could not be computed, and its default held",
            lambda f: count(f, "failed"),
            ("failed",),
        ),
        Column(
            "OLD VALUE HELD",
            "how often an older value held, as it takes too long",
            lambda f: count(f, "held"),
            ("held",),
        ),
        Column("TAKES", "how long it takes", lambda f: duration(f.get("cost")), ("cost",)),
        Column("BUDGET", "how long it may take", lambda f: duration(f.get("budget")), ("budget",)),
    ),
)
_DENIED = {
    "samples": "samples so far",
    "queries": "queries so far",
    "replies": "replies so far",
    "subscribers": "subscribers now",
    "queryables": "queryables now",
    "tokens": "liveliness tokens now",
}


def _denied(name: str, means: str) -> Column:
    return Column(name.upper(), means, lambda d: count(d, name), (name,))


DENIED = Table(
    "What rules of the configuration deny",
    "What may not cross between applications and mesh; shown while there is any.",
    "daemon.denied",
    (
        Column("DENIED", "the direction: out to the mesh, or in from it", lambda d: word(d, "way"), (), name=True),
        *(_denied(name, means) for name, means in _DENIED.items()),
    ),
)
TABLES = (LIMITS, STREAMS, PEERS, KEPT, FEATURES, DENIED)
"""In the order in which they are shown and explained."""


def failing(features: Iterable[Status]) -> list[Status]:
    """Return the features that do not go well."""
    return [each for each in features if each.get("failed") or each.get("held")]
