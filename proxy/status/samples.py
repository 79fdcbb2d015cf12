"""The part of the status that tells what became of samples, and why."""

from typing import Literal

from proxy.status.fields import BYTES, COUNT, SECONDS, WORTH, Part, field


class Counts(Part):
    """What became of the samples that applications of this robot published, since the start."""

    received: int = field("samples that came in", COUNT, alias="in")
    forwarded: int = field("those that were sent, decided or not", COUNT)
    dropped: int = field("those that were dropped", COUNT)
    queued: int = field("those that wait to be decided, or to be sent", COUNT)
    conserved: bool = field("whether in = forwarded + dropped + queued")
    by_reason: dict[str, int] = field(
        "how many by what became of them, for reasons that docs/reference/status.md explains", COUNT
    )
    bytes: dict[str, int] = field("what samples that passed without a decision took on the air, by reason", BYTES)


class Waiting(Part):
    """The copies that are kept for one robot that is away."""

    robot: str = field("its name")
    back: bool = field("whether it is there again, and gets its copies")
    away: float = field("how long ago it was lost", SECONDS)
    samples: int = field("copies that wait for it", COUNT)


class Kept(Part):
    """Copies for robots that are away, of streams of which each sample counts."""

    entered: int = field("copies that were kept", COUNT, alias="in")
    waiting: int = field("those that still wait", COUNT)
    bytes: int = field("payloads that are held for copies", BYTES)
    conserved: bool = field("whether every copy is accounted for")
    by_reason: dict[str, int] = field("how many by what became of them", COUNT)
    waits_for: list[Waiting] = field("for whom they wait", alias="for")
    keys: list[str] = field("key expressions whose samples are taken from applications whoever is here")


class Last(Part):
    """The last decision that a search made."""

    age: float = field("how long ago it was", SECONDS)
    key: str = field("the key of the sample")
    reason: str = field("what became of the sample")
    send: bool = field("whether the best plan sends it")
    utility: float = field("what the best plan earns", WORTH)
    opposite: float | None = field(
        "what the best plan earns that does the opposite; null if it was not worked out", WORTH
    )
    lead: float | None = field("by how much sending is better, or worse; null if unknown", WORTH)
    gap: float | None = field("by how much some plan may still be better, at most; null if unknown", WORTH)
    iterations: int = field("iterations of the search", COUNT)
    nodes: int = field("nodes of its tree", COUNT)
    seconds: float | None = field("how long it took", SECONDS)
    binding: list[str] = field("limits that left no room for more")
    prices: dict[str, float] = field("what a full limit asks for a sample like this one, by limit", WORTH)


class Thinned(Part):
    """Windows that held fewer messages than there were, so that they were decided in time."""

    windows: int = field("how many", COUNT)
    messages: int = field("messages that they held", COUNT)
    of: int = field("messages that they would have held", COUNT)


class Decisions(Part):
    """The decisions since the start."""

    made: int = field("samples that a search decided", COUNT)
    iterations: int = field("iterations of all searches", COUNT)
    proven: int = field("decisions of which it is proven that none is better", COUNT)
    bounded: int = field("decisions of which it is known what is lost at most", COUNT)
    seconds: float = field("time that searches took", SECONDS)
    longest: float = field("time that the longest one took", SECONDS)
    gap: float = field("what all bounded decisions lost at most", WORTH)
    utility: float = field("what the plans of all bounded decisions earn", WORTH)
    would_drop: int = field("samples that went in shadow, and that enforce would have dropped", COUNT)
    unneeded: int = field("samples that went without a search, as there was room for all", COUNT)
    certain: int = field("small samples that went without a search, whatever others said to send", COUNT, default=0)
    undisputed: int = field("samples that went without a search, as they earn what room costs", COUNT)
    hopeless: int = field("samples that were dropped without a search, as they do not earn what room costs", COUNT)
    owed: int = field("samples that went because a guarantee demanded them", COUNT)
    unkept: int = field("samples that a guarantee demanded and that no limit had room for", COUNT)
    late: int = field("samples on which no answer came in time, so that they went if they fitted", COUNT)
    thinned: Thinned = field("windows that held fewer messages than there were")
    binding: dict[str, int] = field("dropped samples that a limit had no room for, by limit", COUNT)
    last: Last | None = field("the last decision of a search; null if there was none")


class Stream(Part):
    """A stream: the samples of one key from one robot."""

    robot: str = field("the robot that publishes it")
    key: str = field("its key")
    type: str = field("the information type of the specs that covers it")
    schedule: str = field("how it generates samples, as far as that is known: periodic, bursts, random; or empty")
    period: float = field("mean time between its samples; 0 while unknown", SECONDS)
    jitter: float = field("standard deviation of that time", SECONDS)
    forecast: dict[str, str] = field(
        "how each feature is forecast, where not all are taken to be as in the last sample"
    )
    size: int = field("the last sample's size", BYTES)
    scale: float = field("the last sample's factor of value, by its features", "factor")
    shown: float | None = field(
        "that factor of the newest sample that receivers should have; null if none, or nobody wants it",
        "factor",
        default=None,
    )
    over: bool = field("whether no more samples are expected")
    generated: int = field("samples that its robot's applications published", COUNT)
    forwarded: int = field("samples that its robot sent", COUNT)
    by_reason: dict[str, int] = field("what was decided on samples of our own, by reason", COUNT)
    receivers: int = field("robots that want it", COUNT)
    latency: float | None = field(
        "what a sample takes to those that want it, in the mean, by our estimates; null if nobody does", SECONDS
    )
    age: float | None = field(
        "how old the newest sample is now that receivers should have; null if none, or nobody wants it", SECONDS
    )
    last_generated: float | None = field("how long ago the last sample was generated; null if unknown", SECONDS)
    last_forwarded: float | None = field("how long ago the last sent one was sent; null if none was", SECONDS)


class Feature(Part):
    """A feature that is computed from samples of a type."""

    type: str = field("the information type")
    feature: str = field("the feature; scale, utility and forecasts that fail are listed, too")
    failed: int = field("how often it could not be computed, so that its default held", COUNT)
    held: int = field("how often an older value held, as computing takes more than its budget", COUNT)
    cost: float | None = field("what computing it takes; null while unknown", SECONDS)
    budget: float | None = field("what computing it may take; null where there is no budget", SECONDS)


Mode = Literal["pass", "shadow", "enforce"]
