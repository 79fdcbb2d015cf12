"""What samples of a type are probably worth, by how they come and what they are; and why."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Literal

from utility_specs.learning.stream import Stream
from utility_specs.learning.toml_text import duration

Coming = Literal["once", "periodic", "events", "random", "bursts"]
"""How samples come: `events` are rare or at random moments far apart, `random` is at random and often."""

FEW = 4
"""With fewer samples nothing is known of when they come, unless their gaps are alike."""
STEADY = 0.25
"""Gaps are alike that differ from their median by at most this part of it."""
MOSTLY = 0.5
"""So many gaps of a periodic stream are alike, whatever is lost; of one at random one in six."""
FAR_APART = 1.0
"""Random samples farther apart are events [s]."""
LIVES = 10.0
"""What is told every period is worth something for so many of them,"""
LEAST_LIFE = 1.0
"""and for so long at least [s]."""
SURE = 12
"""So many samples tell that a stream is random."""
CLEAR = 2.0
"""Random streams of one type have rates within this factor where one is written for all."""


@dataclass(frozen=True, slots=True)
class Worth:
    """A utility, an aggregation and perhaps a schedule, as specs have them, and the reasons for the first two."""

    utility: str
    why: str
    aggregation: str
    combined: str
    schedule: str | None = None


def coming(streams: Sequence[Stream]) -> Coming:
    """Return how samples of most streams come."""
    if all(stream.count == 1 for stream in streams):
        return "once"
    often = [stream for stream in streams if stream.count > 1]
    return Counter(map(_coming, often)).most_common(1)[0][0]


def _coming(stream: Stream) -> Coming:
    """Return how samples of a stream of more than one come, by all of them: its timing goes by the last ones."""
    gaps, kind = stream.gaps, stream.timing.kind
    middle = median(gaps)
    regular = sum(abs(gap - middle) <= STEADY * middle for gap in gaps) / len(gaps)
    if stream.count < FEW:
        return "periodic" if len(gaps) > 1 and regular == 1.0 else "events"
    if kind.startswith("bursts") and stream.count >= SURE:
        return "bursts"
    if kind == "poisson" or regular < MOSTLY:
        return "events" if stream.interval > FAR_APART else "random"
    return "periodic"


def period(streams: Sequence[Stream], how: Coming) -> float:
    """Return how far apart samples of most streams are that come so [s]; 0.0 if all came once."""
    often = [stream for stream in streams if stream.count > 1]
    return median([stream.timing.period if how == "periodic" else stream.interval for stream in often] or [0.0])


def worth_of(streams: Sequence[Stream]) -> Worth:
    """Propose what samples of streams of one kind are worth."""
    how = coming(streams)
    apart = period(streams, how)
    if how == "once":
        return Worth(
            '{ kind = "step", lifetime = "10 min" }',
            "it came once: a map, a plan? Good for long",
            "once",
            "if newer ones replace it, most_recent",
        )
    if streams[0].format in {"image", "ros_image"} and how != "events":
        return Worth(_video(apart), "images: the newer the better", *_NEWEST)
    if how == "events":
        why = "seldom: an alarm? Until it is too late for it"
        every = "each is news; if only the first is, once"
        return Worth('{ kind = "step", lifetime = "10 s" }', why, "sum", every, _schedule(streams, apart))
    if how == "periodic":
        life = max(LEAST_LIFE, float(f"{LIVES * apart:.2g}"))
        why = f"periodic: less and less, nothing after {duration(life)}"
        return Worth(f'{{ kind = "linear", slope = {1.0 / life:.3g} }}', why, *_NEWEST)
    tau = duration(LIVES / 2.0 * apart)
    why = f"{'at random' if how == 'random' else 'in bursts'}: a third is left after {tau}"
    return Worth(f'{{ kind = "exponential", tau = "{tau}" }}', why, *_NEWEST, _schedule(streams, apart))


_NEWEST = ("most_recent", "a newer one replaces the last")


def _video(apart: float) -> str:
    """Return the utility of images, which lasts longer where they come less than once in a second."""
    if apart <= 1.0:
        return '{ kind = "video" }'
    return f'{{ kind = "video", a0 = "{duration(apart)}", a1 = "{duration(100.0 * apart)}" }}'


def _schedule(streams: Sequence[Stream], apart: float) -> str | None:
    """Return the schedule of streams that are clearly random, all at about one rate."""
    for stream in streams:
        alike = apart / CLEAR <= stream.interval <= apart * CLEAR
        if stream.timing.kind != "poisson" or stream.count < SURE or not alike:
            return None
    return f'{{ kind = "poisson", interval = "{duration(apart)}" }}'
