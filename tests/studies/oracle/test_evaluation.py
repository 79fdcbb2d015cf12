"""Each stream by its aggregation."""

from dataclasses import replace

from planner import Aggregation, Linear, Stream
from studies.oracle.evaluation import build_worth
from tests.studies.oracle.problems import Annoyed, of_kind, one_stream


def test_streams_need_what_their_aggregation_needs():
    """A mission of all kinds has the columns of each of them, and messages of `sum` are worth something alone."""
    kinds = (Aggregation.MOST_RECENT, Aggregation.SUM, Aggregation.ONCE, Annoyed())
    problem = one_stream([float(at) for at in range(8)], window=0.5, limit=1.0)
    problem = replace(
        problem,
        streams=tuple(Stream(at, kind) for at, kind in enumerate(kinds)),
        messages=tuple(m._replace(stream=at % 4) for at, m in enumerate(problem.messages)),
    )
    paths, ranks = build_worth(problem)
    recent, once, custom = 1 + 2 + 2 + 2, 2, 2 * (1 + 2) + 3
    assert len(paths.gain) == 8 + recent + once + custom
    assert [at for at in range(8) if paths.gain[at] > 0] == [1, 2, 5, 6]
    assert len(ranks.rank) == 0


def test_ranks_where_the_newest_is_not_the_best():
    """`best` is the same as `most_recent` where messages fade alike, and needs ranks where they do not."""
    alike = of_kind(one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0), Aggregation.BEST)
    paths, ranks = build_worth(alike)
    recent, _ = build_worth(of_kind(alike, Aggregation.MOST_RECENT))
    assert paths.gain.tolist() == recent.gain.tolist()
    assert len(ranks.rank) == 0
    lasting = replace(alike, messages=(alike.messages[0]._replace(utility=Linear(3.0, 0.01)), *alike.messages[1:]))
    paths, ranks = build_worth(lasting)
    assert len(paths.gain) == 3
    assert ranks.message.tolist() == [0, 0, 1, 0, 2, 1]


def test_streams_without_messages_need_nothing():
    """A stream that publishes nothing in a mission has no columns, whatever its kind."""
    problem = one_stream([0.0, 1.0], window=0.5, limit=1.0)
    wider = replace(problem, streams=(*problem.streams, *(Stream(7, kind) for kind in (*Aggregation, Annoyed()))))
    assert build_worth(wider)[0].gain.tolist() == build_worth(problem)[0].gain.tolist()
