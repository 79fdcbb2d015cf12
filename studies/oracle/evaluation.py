"""What the messages of a problem are worth, as columns and rows: each stream by its aggregation."""

from collections.abc import Collection, Iterator

import numpy as np

from planner import Aggregation, Problem
from planner.aggregations.current import Shown
from planner.received import Received
from studies.oracle.aggregations import best, custom, independent, most_recent, once
from studies.oracle.aggregations.best import Ranks, no_ranks
from studies.oracle.aggregations.part import Part, join
from studies.oracle.aggregations.rankings import Rankings, rank


def build_worth(problem: Problem) -> tuple[Part, Ranks]:
    """Build the paths of all streams and the ranks of those that need them, of a valid problem.

    Raises OracleError for an aggregation of the caller's own that has too many states.
    """
    ranked, rankings = _received(problem, _streams(problem, Aggregation.BEST)), {}
    if ranked is not None:
        rankings = {stream: rank(ranked, stream) for stream in np.unique(ranked.stream).tolist()}
    recent = {stream for stream, found in rankings.items() if found.newest_first}
    mixed: list[Rankings] = [found for found in rankings.values() if not found.newest_first]
    ranks = no_ranks() if ranked is None else best.build(ranked, mixed)
    return join(len(problem.messages), list(_paths(problem, recent))), ranks


def _paths(problem: Problem, recent: Collection[int]) -> Iterator[Part]:
    """Yield the paths of all streams but those of `best`, except some where the most recent message is the best."""
    markovian = _received(problem, {*_streams(problem, Aggregation.MOST_RECENT), *recent})
    if markovian is not None:
        yield most_recent.build(markovian)
    current = _received(problem, _streams(problem, Aggregation.CURRENT))
    if current is not None:
        yield most_recent.build(Shown.of(current))
    for kind, build in ((Aggregation.SUM, independent.build), (Aggregation.ONCE, once.build)):
        received = _received(problem, _streams(problem, kind))
        if received is not None:
            yield build(received)
    for stream in sorted({m.stream for m in problem.messages}):
        if not isinstance(problem.streams[stream].aggregation, Aggregation):
            yield custom.build(problem, stream)


def _streams(problem: Problem, kind: Aggregation) -> set[int]:
    return {at for at, stream in enumerate(problem.streams) if stream.aggregation is kind}


def _received(problem: Problem, streams: Collection[int]) -> Received | None:
    """Return the messages of some streams; None if there are none."""
    members = [index for index, m in enumerate(problem.messages) if m.stream in streams]
    opened = sum(not problem.messages[index].sent for index in members)
    return Received(problem, np.array(members, dtype=np.int64), np.arange(opened)) if members else None
