"""Problems and settings without meaning are refused with an error that names what is wrong."""

import dataclasses
import math

import pytest

from planner import (
    Aggregation,
    Constraint,
    PlannerError,
    ProblemError,
    Receiver,
    SearchError,
    SearchSettings,
    Stream,
    Traffic,
    start,
)
from tests.planner.windows import open_messages, window

ENGINES = ("native", "python")
GOOD = window(3, robots=2, horizon=5)


def with_message(index, **changes):
    messages = list(GOOD.messages)
    messages[index] = messages[index]._replace(**changes)
    return dataclasses.replace(GOOD, messages=tuple(messages))


LAST = len(GOOD.messages) - 1

BAD_PROBLEMS = {
    "holds no message": dataclasses.replace(GOOD, messages=()),
    "can be weighed": dataclasses.replace(GOOD, messages=GOOD.messages * 4000),
    "current is message 99": dataclasses.replace(GOOD, current=99),
    "current is message -1": dataclasses.replace(GOOD, current=-1),
    "already sent": with_message(GOOD.current, sent=True),
    "t_start must lie before": dataclasses.replace(GOOD, t_start=GOOD.t_end),
    "t_end": dataclasses.replace(GOOD, t_end=math.inf),
    "window must be > 0": dataclasses.replace(GOOD, constraints=(Constraint("c", 0.0, 1.0),)),
    "limit must be >= 0": dataclasses.replace(GOOD, constraints=(Constraint("c", 1.0, -1.0),)),
    '"c": limit': dataclasses.replace(GOOD, constraints=(Constraint("c", 1.0, math.nan),)),
    "aggregation": dataclasses.replace(GOOD, streams=(GOOD.streams[0]._replace(aggregation="sun"),) * 2),
    "stream 7 is unknown": with_message(0, stream=7),
    "stream -1 is unknown": with_message(0, stream=-1),
    "times must be finite": with_message(LAST, t_rcv=math.nan),
    "times out of order": with_message(LAST, t_rcv=-5.0),
    "scale must be": with_message(LAST, scale=-1.0),
    f"message {LAST}: scale must be": with_message(LAST, scale=math.inf),
    "use must be finite": with_message(LAST, use=(-1.0,)),
    "message 0: use must be finite": with_message(0, use=(math.nan,)),
    "use has 2 entries": with_message(LAST, use=(1.0, 1.0)),
    "traffic 0: use has 0 entries": dataclasses.replace(GOOD, traffic=(Traffic(0.0, ()),)),
    "traffic 0: use must": dataclasses.replace(GOOD, traffic=(Traffic(0.0, (math.inf,)),)),
    "traffic 0: t_sent": dataclasses.replace(GOOD, traffic=(Traffic(math.nan, (1.0,)),)),
    "belongs before": dataclasses.replace(GOOD, messages=GOOD.messages[::-1], current=LAST - GOOD.current),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("says", BAD_PROBLEMS)
def test_bad_problem_is_refused(says, engine):
    """Each kind of nonsense raises ProblemError before any search, whichever engine is asked."""
    with pytest.raises(ProblemError, match=says):
        start(BAD_PROBLEMS[says], SearchSettings(engine=engine))


def test_open_messages_must_be_in_order():
    """Open messages that are sent, or received within a stream, out of order are refused."""
    first, second = open_messages(GOOD)[-2:]
    late = GOOD.messages[second].t_sent + 1.0
    with pytest.raises(ProblemError, match="must not decrease"):
        start(with_message(first, t_sent=late, t_rcv=late), SearchSettings())
    same_stream = with_message(second, stream=GOOD.messages[first].stream)
    messages = list(same_stream.messages)
    messages[first] = messages[first]._replace(t_rcv=messages[second].t_rcv + 1.0)
    with pytest.raises(ProblemError, match="received out of order"):
        start(dataclasses.replace(same_stream, messages=tuple(messages)), SearchSettings())


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"search": "bast"}, "search must be one of best, paper"),
        ({"engine": "fortran"}, "engine must be one of"),
        ({"reduction": "some"}, "reduction must be one of"),
        ({"exploration": math.nan}, "exploration must be"),
        ({"exploration": -1.0}, "exploration must be"),
        ({"max_nodes": 0}, "max_nodes must be"),
        ({"max_nodes": 10**9}, "max_nodes must be"),
    ],
)
def test_bad_settings_are_refused(changes, says):
    """Settings that no engine can follow raise SearchError with the allowed values."""
    with pytest.raises(SearchError, match=says):
        start(GOOD, dataclasses.replace(SearchSettings(), **changes))


def test_all_errors_are_planner_errors():
    """One except clause catches everything that the planner refuses."""
    assert issubclass(ProblemError, PlannerError)
    assert issubclass(SearchError, PlannerError)


@pytest.mark.parametrize(
    ("stream", "says"),
    [
        (Stream(0, receivers=(Receiver(delay=-0.1),)), "stream 1: a receiver's delay must be >= 0 s, not -0.1"),
        (Stream(0, receivers=(Receiver(delay=math.inf),)), "delay must be"),
        (Stream(0, receivers=(Receiver(), Receiver(share=math.nan))), "a receiver's share must be >= 0, not nan"),
        (Stream(0, "newest"), "aggregation must be one of most_recent, best, sum, once, current or have the methods"),
    ],
)
def test_bad_streams_are_refused(stream, says):
    """What cannot be said of a stream is named with its number."""
    with pytest.raises(ProblemError, match=says):
        start(dataclasses.replace(GOOD, streams=(GOOD.streams[0], stream, *GOOD.streams[2:])), SearchSettings())


class Failing:
    """A utility of an operator that cannot be computed."""

    def value(self, age):
        raise ZeroDivisionError(f"{len(age)} ages")

    def integral(self, start, end):
        return end - start


def test_a_utility_that_fails_at_the_age_0_is_named():
    """`current` asks for it before anything is tabulated."""
    streams = tuple(stream._replace(aggregation=Aggregation.CURRENT) for stream in GOOD.streams)
    messages = tuple(message._replace(utility=Failing()) for message in GOOD.messages)
    with pytest.raises(ProblemError, match=r"utility Failing\.value\(\) failed: ZeroDivisionError: 1 ages"):
        start(dataclasses.replace(GOOD, streams=streams, messages=messages), SearchSettings())
