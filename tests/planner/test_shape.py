"""What is no problem at all is refused by the planner's own error, which names it."""

import dataclasses

import numpy as np
import pytest

from planner import Constraint, Linear, ProblemError, Receiver, SearchSettings, Stream, Table, Traffic, start
from planner.shape import check_shape
from tests.planner.windows import window

GOOD = window(3, robots=2, horizon=5)


def changed(**changes):
    return dataclasses.replace(GOOD, **changes)


def with_message(index, **changes):
    messages = list(GOOD.messages)
    messages[index] = messages[index]._replace(**changes)
    return changed(messages=tuple(messages))


def with_receiver(*of_receiver):
    return changed(streams=(GOOD.streams[0], Stream(1, receivers=(Receiver(*of_receiver),))))


WRONG = {
    "current must be a whole number, not 1.0": changed(current=1.0),
    "current must be a whole number, not '1'": changed(current="1"),
    "t_start must be a number, not None": changed(t_start=None),
    "t_end must be a number, not '9.0'": changed(t_end="9.0"),
    "streams must be a tuple of Stream, not None": changed(streams=None),
    "streams must hold only Stream, not 7": changed(streams=(7,)),
    "messages must be a tuple of Message": changed(messages={}),
    "messages must hold only Message, not None": changed(messages=(*GOOD.messages, None)),
    "constraints must hold only Constraint": changed(constraints=("c",)),
    "constraint 0: window must be a number, not '1'": changed(constraints=(Constraint("c", "1", 1.0),)),
    "constraint 0: limit must be a number, not None": changed(constraints=(Constraint("c", 1.0, None),)),
    "stream 0: robot must be a whole number, not 'r'": changed(streams=(Stream("r"), GOOD.streams[1])),
    "stream 1: receivers must be a tuple of Receiver": changed(streams=(GOOD.streams[0], Stream(1, receivers=None))),
    "stream 1: a receiver's delay must be a number": with_receiver("0.1"),
    "stream 1: a receiver's share must be a number": with_receiver(0.1, None),
    "message 2: stream must be a whole number, not 0.0": with_message(2, stream=0.0),
    "message 2: t_gen must be a number, not None": with_message(2, t_gen=None),
    "message 2: t_sent must be a number": with_message(2, t_sent="0.1"),
    "message 2: t_rcv must be a number": with_message(2, t_rcv=[0.1]),
    "message 2: scale must be a number, not '1.5'": with_message(2, scale="1.5"),
    "message 2: sent must be True or False, not 'no'": with_message(2, sent="no"),
    "message 2: utility must have the method integral": with_message(2, utility=1.0),
    "message 2: use must be a tuple of numbers, not 1.0": with_message(2, use=1.0),
    "message 2: use must be a number, not '1.0'": with_message(2, use=("1.0",)),
    "traffic must hold only Traffic": changed(traffic=((0.0, (1.0,)),)),
    "traffic 0: t_sent must be a number, not None": changed(traffic=(Traffic(None, (1.0,)),)),
    "traffic 0: use must be a number, not None": changed(traffic=(Traffic(0.0, (None,)),)),
    "t_start must lie before t_end": changed(t_end=10**400),
}


@pytest.mark.parametrize("says", WRONG)
def test_what_has_the_wrong_type_is_refused(says):
    """The error names the thing, what it must be and what it is; nothing is taken for a number that is none."""
    with pytest.raises(ProblemError, match=says):
        start(WRONG[says], SearchSettings())


@pytest.mark.parametrize("changes", [{"t_rcv": 10**400}, {"scale": 10**400}, {"use": (10**400,)}, {"stream": 10**40}])
def test_numbers_that_no_array_holds_are_refused(changes):
    """Whole numbers of hundreds of digits are no reason to fail otherwise."""
    with pytest.raises(ProblemError, match="too large"):
        start(with_message(2, **changes), SearchSettings())


def test_numbers_of_numpy_are_numbers():
    """Whole and real numbers, and flags, may be NumPy's, and a tuple may be a list."""
    kinds = (np.int64, np.float64, np.float32, np.float64, lambda utility: utility, np.float64, list, np.bool_)
    messages = [m._make(kind(field) for kind, field in zip(kinds, m, strict=True)) for m in GOOD.messages]
    check_shape(changed(messages=messages, current=np.int32(GOOD.current), t_end=np.float32(GOOD.t_end)))


@pytest.mark.parametrize("wrong", ["1.0", None, 1j, 10**400])
def test_utilities_take_numbers_only(wrong):
    """A parameter that is no number is refused where the utility is made."""
    for make in (lambda: Linear(wrong, 1.0), lambda: Linear(1.0, wrong), lambda: Table(((0.0, 1.0), (1.0, wrong)))):
        with pytest.raises(ProblemError, match="must"):
            make()
