"""Aggregations of a caller's own, to test the planner on."""

import numpy as np

from planner import Message


class Coverage:
    """Messages see the stretch from their `t_gen` to `reach` later; worth is what all together have seen.

    Its states are as many as there are sets of messages that see different stretches.
    """

    def __init__(self, reach=1.0, step=0.1):
        self._reach, self._step = reach, step

    def empty(self):
        return frozenset()

    def add(self, state, message: Message):
        first = round(message.t_gen / self._step)
        return state | set(range(first, first + round(self._reach / self._step)))

    def value(self, state, t_end):  # noqa: ARG002 - what was seen stays seen
        return self._step * len(state)


class Newest:
    """`most_recent` once more, as a caller would write it: the state is everything that was received."""

    def empty(self):
        return ()

    def add(self, state, message: Message):
        return (*state, message)

    def value(self, state, t_end):
        ends = [m.t_rcv for m in state[1:]] + [t_end]
        return sum(self._worth(m, end) for m, end in zip(state, ends, strict=True)) if state else 0.0

    def _worth(self, message, end):
        ages = np.array([message.t_rcv - message.t_gen]), np.array([end - message.t_gen])
        return message.scale * float(message.utility.integral(*ages)[0])


class Failing:
    """A model that does what it should not: raises, or returns nonsense, in the method of this name."""

    def __init__(self, method, result):
        self._method, self._result = method, result

    def _answer(self, method, right):
        if method != self._method:
            return right
        if isinstance(self._result, BaseException):
            raise self._result
        return self._result

    def empty(self):
        return self._answer("empty", 0)

    def add(self, state, message: Message):  # noqa: ARG002
        return self._answer("add", state + 1)

    def value(self, state, t_end):  # noqa: ARG002
        return self._answer("value", float(state))
