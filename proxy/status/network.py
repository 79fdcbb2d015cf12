"""The part of the status that tells of limits and of other robots."""

from proxy.status.fields import BYTES, COUNT, SECONDS, SHARE, Part, field


class Adaptive(Part):
    """How an adaptive limit came to be what it is."""

    in_force: float = field("what is in force, as a part of the ceiling", SHARE)
    estimate: float = field("what this robot believes the channel bears", SHARE)
    told: float = field("what this robot allows by its own evidence", SHARE)
    floor: float = field("what holds whatever the channel does", SHARE)
    ceiling: float = field("the limit that the spec sets, in its unit", "unit of the limit")
    used: float = field("how much of what is in force all robots use", SHARE)
    delay: float | None = field("how long messages wait in the channel's queue; null while unknown", SECONDS)
    lost: float | None = field("what is lost beyond the usual; null while unknown", SHARE)
    reason: str = field("what it reacts to")


class OnAir(Part):
    """What this robot put on the air since the start."""

    messages: int = field("messages, copies counted", COUNT)
    bytes: int = field("bytes, copies counted", BYTES)


class Digests(Part):
    """What robots tell each other about streams and channel, in digests and states."""

    allowance: float = field("what all robots together may tell", "B/s")
    told: int = field("what this robot told since the start, copies and framing counted", BYTES)
    heard: int = field("the same of the others, as far as this robot heard or has to expect", BYTES)


class Limit(Part):
    """A limit of the specs, in force."""

    constraint: str = field("its name")
    kind: str = field("what it limits: throughput, messages, airtime, energy")
    unit: str = field("the unit of limit, held, used and used_by_all: B, messages, s or J")
    window: float = field("in any window of this length the limit holds", SECONDS)
    limit: float = field("what all robots may use together in a window (of energy: this robot)", "unit of the limit")
    held: float = field("what this robot may use of that: all in announce, its part in split", "unit of the limit")
    used: float = field("what this robot used in the window that ends now", "unit of the limit")
    used_by_all: float = field(
        "what all robots used in the window that ends now, as far as this one knows", "unit of the limit"
    )
    price: float = field("what a unit of it costs now: what the last unit earns", "utility·s per unit of the limit")
    price_per_kb: float = field("what 1000 bytes more in one copy cost now", "utility·s per kB")
    members: int = field("robots that share it", COUNT)
    adaptive: Adaptive | None = field("how it follows the channel; only of adaptive limits", default=None)


class Latency(Part):
    """What samples take from being sent to being received."""

    fixed: float = field("whatever their size", SECONDS)
    per_byte: float = field("for each byte more", "s/B")


class Peer(Part):
    """Another robot."""

    robot: str = field("its name here: one of a name that was taken has a part of its zid behind it")
    zid: str = field("the id of its session on the mesh")
    mode: str = field("what it does with decisions: pass, shadow or enforce; empty while it has not said")
    transport: str = field("how its samples travel: unicast, broadcast; empty while it has not said")
    version: str | None = field("the Sendworthy that it runs; null while it has not said")
    wire_version: int | None = field(
        "the version of the protocol that it speaks; null while it has not said", "version"
    )
    takes_part: bool = field("whether others plan with it; if not it is like a plain Zenoh node")
    specs: str = field("the generation of its specs; empty while it has not said")
    latency_in: Latency | None = field("what its samples take to us; null while unknown")
    latency_out: Latency | None = field("what ours take to it; null while unknown")
    loss_in: float | None = field("the part of its samples that do not reach us; null while unknown", SHARE)
    loss_out: float | None = field("the part of ours that do not reach it; null while unknown", SHARE)
    clock_offset: float = field("its monotonic clock minus ours", SECONDS)
    clock_uncertainty: float | None = field("within what that is known; null while unknown", SECONDS)
    clock_jumps: int = field("how often its clock jumped", COUNT)
    wall_ahead: float | None = field("its wall clock minus ours; null while unknown", SECONDS)
    wall_error: float | None = field(
        "what its wall clock is wrong by at most, as it says; null if it does not", SECONDS
    )
    digest_age: float | None = field("how long ago its last digest came; null if none did", SECONDS)
    samples: int = field("samples of it that came", COUNT)
    implausible: int = field("those whose timestamp could not be right", COUNT)
    received_of_ours: int = field("samples of ours that it got, as it says", COUNT)
    sent: int = field("samples that we sent to it", COUNT)


class Sized(Part):
    """Samples that wait somewhere."""

    samples: int = field("how many", COUNT)
    bytes: int = field("how large together", BYTES)
