"""What a replay reached, as plain data: altogether, by type, and piece by piece."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner.utility import Flags, Floats
from studies.replay.bound import Bound
from studies.replay.outcomes import Columns, Outcomes
from studies.replay.pieces import Gains
from studies.replay.violations import violating

VERSION = 1
"""Of the report: what would be misread has a greater one."""
STEPS = 120
"""Pieces of the course, of a second at least."""
PUBLISHED = "published"
"""What became of a sample of which nothing but that is recorded."""

Report = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Flown:
    """A replay that is over: what became of all samples, and the pieces in which that is counted."""

    outcomes: Outcomes
    columns: Columns
    borders: Floats

    def types(self) -> dict[str, Flags]:
        """Return by type which samples belong to it, those that no spec covers last."""
        streams = self.outcomes.streams
        named = sorted(streams, key=lambda stream: stream.covering is None)
        return {
            name: np.isin(self.columns.stream, [i for i, s in enumerate(streams) if s.type_name == name])
            for name in dict.fromkeys(stream.type_name for stream in named)
        }


def report(flown: Flown, bounded: Bound | None, told: float = 0.0) -> Report:
    """Describe a replay beside its bound; robots told each other so many bytes."""
    outcomes, columns = flown.outcomes, flown.columns
    gains = Gains(outcomes, columns, flown.borders)
    gained, everything = gains.of(columns.t_rcv), gains.of(columns.t + outcomes.mission.latency)
    over = violating(outcomes, columns)
    seconds = outcomes.seconds
    everybody = np.ones(len(columns.t), dtype=np.bool_)
    whole = _counted(flown, everybody, over, seconds.values())
    whole |= {
        "utility": float(gained.sum()),
        "utility_all": float(everything.sum()),
        "bound": None if bounded is None else bounded.utility,
    }
    types = {}
    for name, own in flown.types().items():
        streams = [i for i, stream in enumerate(outcomes.streams) if stream.type_name == name]
        types[name] = _counted(flown, own, over, [seconds[name]] if name in seconds else []) | {
            "utility": float(gained[:, streams].sum()),
            "utility_all": float(everything[:, streams].sum()),
            "bound": None if bounded is None else bounded.by_type.get(name, 0.0),
        }
    return {
        "version": VERSION,
        "seconds": float(flown.borders[-1] - flown.borders[0]),
        **whole,
        "told_bytes": told,
        "limits": _limits(outcomes),
        "types": types,
        "differences": _differences(flown),
        "course": _course(flown),
        "pieces": _pieces(flown, gained.sum(axis=1), everything.sum(axis=1), bounded),
    }


def _counted(flown: Flown, own: Flags, over: Flags, searches: Iterable[list[float]]) -> Report:
    """Return what is counted of some samples."""
    columns, reasons = flown.columns, flown.outcomes.reasons
    sent = own & columns.sent
    took = np.sum([np.zeros(2), *map(np.array, searches)], axis=0)
    fates = Counter(columns.fate[own].tolist())
    return {
        "messages": int(own.sum()),
        "forwarded": int(sent.sum()),
        "bytes": int(columns.size[sent].sum()),
        "bytes_all": int(columns.size[own].sum()),
        "violations": int((over & own).sum()),
        "decisions": int(took[1]),
        "seconds_per_decision": float(took[0] / took[1]) if took[1] else 0.0,
        "lost": int(np.isnan(columns.t_rcv[sent]).sum()),
        "age": _age((columns.t_rcv - columns.t_gen)[sent & ~np.isnan(columns.t_rcv)]),
        "reasons": {reasons[fate]: count for fate, count in fates.most_common()},
    }


def _age(ages: Floats) -> dict[str, float] | None:
    """Return how old samples are when they arrive [s]; None where none does."""
    if not len(ages):
        return None
    median, late = np.quantile(ages, (0.5, 0.95)).tolist()
    return {"mean": float(ages.mean()), "median": median, "p95": late}


def _limits(outcomes: Outcomes) -> list[Report]:
    measures = [(limit.name, limit.measure) for limit in outcomes.mission.limits if not limit.robot]
    return [{"name": n, "kind": m.kind, "limit": m.limit, "unit": m.unit, "window": m.window} for n, m in measures]


def _differences(flown: Flown) -> list[Report]:
    """Return how many samples fared otherwise than they did when they were recorded, and why, by type.

    What still waited at the end is no difference.
    """
    columns, reasons = flown.columns, flown.outcomes.reasons
    found = []
    for name, own in flown.types().items():
        pairs = zip(columns.recorded[own].tolist(), columns.fate[own].tolist(), columns.sent[own].tolist(), strict=True)
        for (before, now, sent), count in Counter(pairs).most_common():
            recorded = reasons[before] if before else PUBLISHED
            if now and recorded.startswith("dropped:") == sent:
                found.append({"type": name, "recorded": recorded, "replayed": reasons[now], "messages": count})
    return sorted(found, key=lambda each: -int(each["messages"]))


def _course(flown: Flown) -> list[Report]:
    """Return what is gained and sent as time goes by, in shorter pieces that nobody bounds."""
    seconds = float(flown.borders[-1] - flown.borders[0])
    fine = np.linspace(flown.borders[0], flown.borders[-1], 1 + min(STEPS, max(1, int(seconds))))
    gains = Gains(flown.outcomes, flown.columns, fine)
    columns = flown.columns
    everything = gains.of(columns.t + flown.outcomes.mission.latency).sum(axis=1)
    return _pieces(Flown(flown.outcomes, columns, fine), gains.of(columns.t_rcv).sum(axis=1), everything, None)


def _pieces(flown: Flown, gained: Floats, everything: Floats, bounded: Bound | None) -> list[Report]:
    columns, borders = flown.columns, flown.borders
    held = np.clip(np.searchsorted(borders, columns.t, side="right") - 1, 0, len(borders) - 2)
    count, sent = len(borders) - 1, columns.sent
    offered = np.bincount(held, columns.size, minlength=count)
    carried = np.bincount(held[sent], columns.size[sent], minlength=count)
    return [
        {
            "begin": float(borders[i]),
            "end": float(borders[i + 1]),
            "utility": float(gained[i]),
            "utility_all": float(everything[i]),
            "bound": None if bounded is None else float(bounded.by_piece[i]),
            "bytes": int(carried[i]),
            "bytes_all": int(offered[i]),
        }
        for i in range(count)
    ]
