"""The demo's figures, from its events alone: `python -m studies.demo.figures EVENTS` prints them as JSON.

Red frames are those of which at least `RED` is red. Ages are in seconds: a frame's from publication to
receipt, the screen's staleness from the publication of what is shown to the moment one looks.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from planner.utility import Floats
from studies.demo.events import EVERYONE, Counts, Event, Links, Serve, Tell, read_events
from studies.demo.layout import OPERATOR
from studies.demo.nodes import WITHOUT
from studies.demo.optimum import find_optimum
from studies.demo.recording import Feed, Recording, recordings

LARGE = 512
"""Chunks of this size are of frames: what daemons tell each other is smaller [B]."""

Figures = dict[str, float | None]
"""By name; counts and truth values are numbers too."""


def figures(events: Iterable[Event]) -> dict[str, Figures]:
    """Return the figures of every run, by phase. What lacks frames, or SciPy, to be said is None."""
    return {phase: _figures(recording) for phase, recording in recordings(events).items()}


def _figures(recording: Recording) -> Figures:
    classes: Figures = {}
    for name, red in (("red", True), ("other", False)):
        classes |= _of_class(recording.feeds, name, red=red)
    return (
        classes
        | _of_ends(recording.feeds)
        | _of_medium(recording)
        | _of_utility(recording, classes)
        | _of_checks(recording)
    )


def _of_class(feeds: Sequence[Feed], name: str, *, red: bool) -> Figures:
    ages = np.concatenate([feed.ages[feed.sees_red[feed.frame] == red] for feed in feeds])
    looks = [feed.staleness() for feed in feeds]
    staleness = np.concatenate([age[sees_red == red] for age, sees_red in looks])
    seconds = sum(feed.seconds(red=red) for feed in feeds)
    return {
        f"seconds_{name}": seconds,
        f"fps_{name}": len(ages) / seconds if seconds else None,
        f"age_p50_{name}": _percentile(ages, 50),
        f"age_p95_{name}": _percentile(ages, 95),
        f"staleness_p50_{name}": _percentile(staleness, 50),
        f"staleness_p95_{name}": _percentile(staleness, 95),
    }


def _of_ends(feeds: Sequence[Feed]) -> Figures:
    """How soon the operator sees something red, and that it is gone, and how long all screens are wrong then [s]."""
    starts = np.concatenate([feed.starts() for feed in feeds])
    ends = np.concatenate([feed.ends() for feed in feeds])
    oldest = max((float(age.max()) for feed in feeds for age in [feed.staleness()[0]] if len(age)), default=None)
    return {
        "events": len(starts),
        "start_p95": _percentile(starts, 95),
        "end_p95": _percentile(ends, 95),
        "false_red": sum(feed.false_red() for feed in feeds),
        "staleness_max": oldest,
    }


def _of_medium(recording: Recording) -> Figures:
    """Bytes, and the most that any window of the constraint saw as a share of what the spec allows.

    Offered is what was let through, frame by frame: without the filter everything, when it was published; else what
    was received, when it was sent, for a frame may wait until its robot may send. On the medium a frame lasts
    for as long as its bytes take there, behind those of others: its windows say nothing of a limit that is kept.
    """
    run = recording.run
    served = [e for e in recording.of(Serve) if run.start <= e.t <= run.start + run.seconds]
    filtered = run.phase != WITHOUT
    offered_at = np.concatenate([_sent_at(recording, feed) if filtered else feed.t_gen for feed in recording.feeds])
    offered = np.concatenate([feed.size[feed.frame] if filtered else feed.size for feed in recording.feeds])
    allowed = run.limit / 8 * run.window
    times, sizes = np.array([e.t for e in served]), np.array([e.size for e in served], dtype=np.float64)
    return {
        "published_bytes": int(sum(feed.size.sum() for feed in recording.feeds)),
        "received_bytes": int(sum(feed.size[feed.frame].sum() for feed in recording.feeds)),
        "medium_bytes": int(sizes.sum()),
        "medium_max_share": _fullest(times, sizes, run.window) / allowed,
        "offered_max_share": _fullest(offered_at, offered, run.window) / allowed,
    }


def _sent_at(recording: Recording, feed: Feed) -> Floats:
    """When each received frame was sent, as the medium shows: by its first chunk after the frame before it [s]."""
    to_operator = (e for e in recording.of(Serve) if (e.source, e.sink) == (feed.robot, OPERATOR) and e.size >= LARGE)
    carried = np.sort([e.t - recording.run.start for e in to_operator])
    after = np.maximum(feed.t_gen[feed.frame], np.append(-np.inf, feed.t_rcv)[:-1])
    return np.asarray(np.minimum(np.append(carried, np.inf)[np.searchsorted(carried, after)], feed.t_rcv))


def _of_utility(recording: Recording, classes: Figures) -> Figures:
    gained = sum(feed.utility() for feed in recording.feeds)
    shares: Figures = {
        "utility": gained,
        "utility_share": gained / sum(feed.utility_undelayed() for feed in recording.feeds),
        "utility_share_optimum": None,
        "fps_ratio": _ratio(classes["fps_red"], classes["fps_other"]),
        "fps_ratio_optimum": None,
    }
    optimum = find_optimum(recording)
    if optimum is not None:
        shares["utility_share_optimum"] = gained / optimum.utility
        shares["fps_ratio_optimum"] = _ratio(optimum.fps_red, optimum.fps_other)
    return shares


def _of_checks(recording: Recording) -> Figures:
    """Do the counts add up, and did all bytes go through the medium? Stock routers count nothing: None."""
    counts = recording.of(Counts)
    by_kernel = any(e.sink == EVERYONE for e in recording.of(Serve))
    to_operator = sum(e.size for e in recording.of(Serve) if e.sink == OPERATOR)
    received = sum(int(feed.size[feed.frame].sum()) for feed in recording.feeds)
    published = Counter({feed.robot: len(feed.t_gen) for feed in recording.feeds})
    published.update(tell.robot for tell in recording.of(Tell))
    conserved = all(c.received == c.forwarded + c.dropped + c.queued == published[c.robot] for c in counts)
    return {
        "conserved": conserved if counts else None,
        "direct_links": max((look.direct for look in recording.of(Links)), default=0),
        "direct_bytes": None if by_kernel else max(0, received - to_operator),
    }


def _percentile(values: Floats, q: float) -> float | None:
    return float(np.percentile(values, q)) if len(values) else None


def _ratio(red: float | None, other: float | None) -> float | None:
    return red / other if red is not None and other else None


def _fullest(times: Floats, sizes: Floats, window: float) -> float:
    """Return the most bytes in any closed window [B]."""
    order = np.argsort(times, kind="stable")
    times, total = times[order], np.append(0.0, np.cumsum(sizes[order]))
    first = np.searchsorted(times, times - window, side="left")
    return float((total[1:] - total[first]).max(initial=0.0))


def main() -> None:
    """Recompute the figures of a file of events."""
    json.dump(figures(read_events(Path(sys.argv[1]))), sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
