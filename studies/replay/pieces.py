"""Recorded traffic cut into pieces of time, and what was gained in each.

What is gained in a piece is the utility of its time, whichever samples it comes from; where all samples of a stream add
up, it is what those are worth that were generated in it, up to the end of all.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from planner import Aggregation, Message, Problem, Stream
from planner.definition import utility
from planner.utility import Flags, Floats, Ints
from studies.replay.outcomes import Columns, Outcomes
from studies.shown import excess
from utility_specs.lifetimes import initial

LENGTH = 100.0
"""Of a piece [s]."""
SHORTEST = 5.0
"""What is left at the end and shorter belongs to the piece before it [s]."""
MOST = 6_000
"""Samples of a piece; of more, pieces are shorter."""


def borders_of(times: Floats, end: float) -> Floats:
    """Return where pieces begin, and the end of the last [s]; `times` are when samples were published."""
    begins = np.arange(0.0, end, LENGTH)
    edges = np.append(begins[: 1 + int(np.sum(begins[1:] <= end - SHORTEST))], end)
    while len(times):
        held = np.diff(np.searchsorted(times, edges))
        crowded = (held > MOST) & (np.diff(edges) > 1e-3)
        if not crowded.any():
            break
        edges = np.unique(np.append(edges, ((edges[1:] + edges[:-1]) / 2)[crowded]))
    return edges


@dataclass(frozen=True, slots=True)
class Gains:
    """Adds up what deliveries are worth [utility·s], by piece and stream."""

    outcomes: Outcomes
    columns: Columns
    borders: Floats

    def of(self, t_rcv: Floats) -> Floats:
        """Return what is gained where samples are received at these times [s; NaN: never]: `[piece, stream]`."""
        gained = np.zeros((len(self.borders) - 1, len(self.outcomes.streams)))
        came = ~np.isnan(t_rcv) & (t_rcv < self.borders[-1])
        by_stream = np.argsort(self.columns.stream, kind="stable")
        starts = np.searchsorted(self.columns.stream[by_stream], np.arange(len(self.outcomes.streams) + 1))
        for number, stream in enumerate(self.outcomes.streams):
            every = by_stream[starts[number] : starts[number + 1]]
            own = every[came[every]]
            own = own[np.argsort(t_rcv[own], kind="stable")]
            if stream.covering is not None and len(own):
                gained[:, number] = self._of_stream(own, t_rcv[own], stream.aggregation)
                if stream.aggregation is Aggregation.CURRENT:
                    gained[:, number] -= self._lost(every, own, t_rcv[own])
        return gained

    def _of_stream(self, own: Ints, times: Floats, aggregation: object) -> Floats:
        """Return what samples of a stream gain that are received at these times, in order."""
        match aggregation:
            case Aggregation.MOST_RECENT | Aggregation.CURRENT:
                return self._shown(own, times)
            case Aggregation.ONCE:
                return self._shown(own[:1], times[:1])
            case Aggregation.SUM:
                ends = np.full(len(own), self.borders[-1])
                return self._by_piece(self.columns.t[own], self.worth(own, times, ends))
            case Aggregation.BEST:
                return self._best(own, times)
        whole = self._defined(own, times, float(self.borders[0]), float(self.borders[-1]))
        return self._by_piece(times[-1:], np.array([whole]))

    def _shown(self, own: Ints, times: Floats) -> Floats:
        """Each sample counts until the next one, over whatever borders."""
        begins = np.unique(np.concatenate((times, self.borders[:-1][self.borders[:-1] > times[0]])))
        ends = np.append(begins[1:], self.borders[-1])
        shown = own[np.searchsorted(times, begins, side="right") - 1]
        return self._by_piece(begins, self.worth(shown, begins, ends))

    def _lost(self, every: Ints, own: Ints, times: Floats) -> Floats:
        """What those of all samples of a stream show too much that are received at these times, in order."""
        columns = self.columns
        made = every[np.argsort(columns.t_gen[every], kind="stable")]
        begins, which, shown = excess(
            (times, columns.scale[own]),
            (columns.t_gen[made], columns.scale[made]),
            float(self.borders[-1]),
            self.borders,
        )
        kinds, at = np.unique(columns.worth[own[which]], return_inverse=True)
        each = np.array([initial(self.outcomes.utility(kind)) for kind in kinds.tolist()])
        return self._by_piece(begins, each[at] * shown)

    def _best(self, own: Ints, times: Floats) -> Floats:
        """At any time that sample counts which is worth most."""
        gained = np.zeros(len(self.borders) - 1)
        carried, taken = own[:0], 0
        for piece, (begin, end) in enumerate(zip(self.borders[:-1], self.borders[1:], strict=True)):
            upto = int(np.searchsorted(times, end))
            here = np.concatenate((carried, own[taken:upto]))
            if len(here):
                at = np.concatenate((np.full(len(carried), begin), times[taken:upto]))
                gained[piece] = self._defined(here, at, float(begin), float(end))
            carried, taken = undominated(self.outcomes, self.columns, here), upto
        return gained

    def _defined(self, own: Ints, times: Floats, begin: float, end: float) -> float:
        """Return what the samples are worth by the definition of their stream's aggregation."""
        columns, stream = self.columns, self.outcomes.streams[int(self.columns.stream[own[0]])]
        facts = [
            Message(
                0,
                float(columns.t_gen[i]),
                float(columns.t_gen[i]),
                float(t),
                self.outcomes.utility(int(columns.worth[i])),
                float(columns.scale[i]),
                (),
                sent=True,
            )
            for i, t in zip(own.tolist(), times.tolist(), strict=True)
        ]
        problem = Problem((Stream(0, stream.aggregation),), tuple(facts), 0, (), (), t_start=begin, t_end=end)
        return utility(problem, ())

    def worth(self, samples: Ints, begins: Floats, ends: Floats) -> Floats:
        """Return what each sample is worth from one time to another [utility·s]."""
        columns, worth = self.columns, np.zeros(len(samples))
        for kind in np.unique(columns.worth[samples]).tolist():
            of_kind = np.flatnonzero(columns.worth[samples] == kind)
            born = columns.t_gen[samples[of_kind]]
            area = self.outcomes.utility(kind).integral(begins[of_kind] - born, ends[of_kind] - born)
            worth[of_kind] = columns.scale[samples[of_kind]] * area
        return worth

    def _by_piece(self, times: Floats, worth: Floats) -> Floats:
        place = np.clip(np.searchsorted(self.borders, times, side="right") - 1, 0, len(self.borders) - 2)
        return np.bincount(place, worth, minlength=len(self.borders) - 1).astype(np.float64)


def undominated(outcomes: Outcomes, columns: Columns, samples: Ints) -> Ints:
    """Return those of a stream's samples that may be worth more than all newer ones at some time, oldest first.

    One of the same utility that is newer and has no smaller scale is worth as much at least, where the utility only
    falls with age; with `current` one of the same scale, for one of a greater scale may show too much. Of others all
    are kept.
    """
    if not len(samples):
        return samples
    samples = samples[np.argsort(columns.t_gen[samples], kind="stable")]
    keep = np.ones(len(samples), dtype=np.bool_)
    for kind in np.unique(columns.worth[samples]).tolist():
        places = np.flatnonzero(columns.worth[samples] == kind)
        if len(places) > 1 and falls(outcomes, kind):
            scales = columns.scale[samples[places]]
            if outcomes.streams[int(columns.stream[samples[0]])].aggregation is Aggregation.CURRENT:
                keep[places] = False
                keep[places[len(scales) - 1 - np.unique(scales[::-1], return_index=True)[1]]] = True
                continue
            newer = np.maximum.accumulate(scales[::-1])[::-1]
            keep[places[:-1]] = scales[:-1] > newer[1:]
    return samples[keep]


def falls(outcomes: Outcomes, worth: int) -> bool:
    """Whether a utility only falls with age."""
    found = outcomes.utility(worth)
    ages = getattr(found, "points", None)
    if ages is not None:
        values = [value for _, value in ages]
        return all(later <= earlier for earlier, later in pairwise(values))
    return type(found).__name__ != "Custom"


def in_pieces(borders: Floats, times: Floats) -> Iterator[tuple[float, float, Flags]]:
    """Yield begin and end of each piece, and which samples were published in it."""
    for begin, end in zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True):
        yield begin, end, np.asarray((times >= begin) & (times < end))
