"""The bounds of what daemons tell each other. What is beyond them is malformed, or told as the bound."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ProtocolTuning:
    """One field for each bound, and what of bids counts as the same."""

    digest_bytes: int = 8192
    """The largest digest [B]."""
    state_bytes: int = 262_144
    """The largest state, before it is compressed [B]: of as many streams as a view holds, with usual keys."""
    backlog_bytes: int = 131_072
    """The largest message on copies that wait [B]."""
    head_bytes: int = 32
    """The first two fields of a message take no more [B]."""
    time: float = 1e10
    """The latest time, and the longest distance between two [s]."""
    count: int = 2**53
    """The largest of all counts that have no bound of their own."""
    samples: int = 2**40
    """Samples of a stream: a thousand a second for thirty years."""
    sample_bytes: int = 2**30
    """The largest sample: that of Zenoh [B]."""
    period: float = 86_400.0
    """The longest period [s]: a slower stream is told as this slow."""
    phases: int = 1_000_000
    """What is further off a rhythm is told as so far off [`PHASES` of its period]."""
    latency: float = 3600.0
    """The longest time on the way [s], and the longest that a byte adds [s/B]."""
    scale: float = 1e15
    """The largest value of a sample."""
    features: int = 32
    """Features of a sample."""
    entry_fields: int = 32
    """Fields for one stream in a state or an announcement; later versions may have more than this one."""
    streams: int = 4096
    """Streams in a state."""
    subscriptions: int = 1024
    """Subscriptions in a state."""
    origins: int = 256
    """Origins in a state."""
    subscription_bytes: int = 80_000
    """All subscriptions of a state [B]."""
    rest_bytes: int = 8192
    """What a state has beside streams and subscriptions takes less [B]: origins, and what is told of parts."""
    key_bytes: int = 1024
    """The longest key, key expression or name [B]."""
    version_text: int = 64
    """Letters in the version of a daemon."""
    clock_error: float = 1.0
    """A wall clock of which no more is known than this is not known [s]."""
    segments: int = 8
    """Segments of a bid."""
    turns: int = 64
    """Turn numbers in a digest."""
    unused_ticks: int = 100_000
    """For how long no slot was used, at most [ticks]."""
    askable: int = 64
    """Of so many robots of a team one can ask again."""
    slots_alike: float = 2.0
    """Slots are worth about as much where it is up to so many times."""
    few_parts: int = 500
    """So much is little beside slots [units]: else five robots of random sizes reached 79 % of central, not 87."""


TUNING = ProtocolTuning()
