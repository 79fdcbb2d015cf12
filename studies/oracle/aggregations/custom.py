"""An aggregation of the caller's own: a plan is a path through the states of its stream.

A stream of n open messages has a node for each of them and each state in which the message may find the stream, as the
planner tabulates them, and one for the end:

    (k, s) → (k + 1, s)    gains nothing: message k is not sent
    (k, s) → (k + 1, s')   gains what the message adds in state s, and leads to s'; all these arcs together carry
                           the fraction of the message that is sent

The path begins with an arc that gains what the messages known to be sent are worth without any other.
"""

from dataclasses import replace

import numpy as np

from planner import Problem
from planner.aggregations.custom import MAX_STATES
from planner.evaluation import Gains, tabulate_gains
from planner.utility import Ints
from studies.oracle.aggregations.part import Entries, Part, arcs, joined
from studies.oracle.errors import OracleError


def build(problem: Problem, stream: int) -> Part:
    """Build the network of one stream; raise OracleError when it has more states than the planner tabulates."""
    own = [index for index, m in enumerate(problem.messages) if m.stream == stream]
    gains = tabulate_gains(replace(problem, messages=tuple(problem.messages[index] for index in own), current=0))
    if not gains.closed:
        raise OracleError(
            f"stream {stream}: what {type(problem.streams[stream].aggregation).__name__} makes of its messages has more"
            f" than {MAX_STATES} states: there is no bound for it; ask for a shorter mission, or let tantamount states"
            " be equal"
        )
    opened = np.array([index for index in own if not problem.messages[index].sent], dtype=np.int64)
    return _network(gains, opened, len(problem.messages))


def _network(gains: Gains, opened: Ints, messages: int) -> Part:
    levels, nodes = len(opened), int(gains.start[-1])
    level = np.repeat(np.arange(levels), np.diff(gains.start))
    state = np.arange(nodes) - gains.start[level]
    last = level == levels - 1
    dropped = np.where(last, nodes, gains.start[level + 1] + state)
    sent = np.where(last, nodes, gains.start[level + 1] + gains.after)
    tail = np.concatenate((np.arange(nodes), np.arange(nodes), [nodes + 1]))
    column = messages + np.arange(len(tail))
    # The nodes of all states, the end, the begin; then what the arcs that send each message carry.
    sends = nodes + 2 + np.arange(levels)
    supply = np.zeros(nodes + 2 + levels)
    supply[nodes] = 1.0
    supply[nodes + 1] = -1.0
    balance = [
        arcs(column, tail, np.concatenate((dropped, sent, [0]))),
        Entries(sends[level], column[nodes : 2 * nodes], np.ones(nodes)),
        Entries(sends, opened, -np.ones(levels)),
    ]
    return Part(
        gain=np.concatenate((np.zeros(messages + nodes), gains.gain, [gains.facts])),
        balance=joined(balance),
        supply=supply,
        skips=np.zeros(messages + len(tail), dtype=np.int64),
    )
