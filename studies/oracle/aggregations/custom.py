"""An aggregation of the caller's own: a plan is a path through the states of its stream.

A stream of n open messages has a node (k, s) for each state s in which message k may find it, one (n, s) for each
state in which it may end, and one for the end itself:

    (k, s) → (k + 1, s)    message k is not sent
    (k, s) → (k + 1, s')   it is sent, which leads to s'; all these arcs together carry the fraction of the message
    (n, s) → end           gains what state s is worth

Messages known to be sent lie between the nodes. Of equal states there is one node, so what a mission takes depends on
the model: one that remembers a number has few, one that remembers all it received has too many.
"""

from dataclasses import dataclass, field

import numpy as np

from planner import Problem
from planner.aggregations.custom import CustomStream, States
from studies.oracle.aggregations.part import Entries, Part, arcs, joined
from studies.oracle.errors import OracleError

MAX_NODES = 200_000
"""What a solver gets through in a minute; more of one stream are refused."""


@dataclass(slots=True)
class _Network:
    """Arcs as they come up; `sent[j]` is the number of the message that arc j sends, −1 for none."""

    nodes: int = 1
    tail: list[int] = field(default_factory=list)
    head: list[int] = field(default_factory=list)
    sent: list[int] = field(default_factory=list)
    gain: list[float] = field(default_factory=list)

    def arc(self, tail: int, head: int, *, sent: int = -1, gain: float = 0.0) -> None:
        """Add an arc."""
        self.tail.append(tail)
        self.head.append(head)
        self.sent.append(sent)
        self.gain.append(gain)

    def node(self, known: dict[States, int], states: States) -> int:
        """Return the node of a state among those known, a new one if it is none of them."""
        if states not in known:
            known[states] = self.nodes
            self.nodes += 1
        return known[states]


def build(problem: Problem, stream: int) -> Part:
    """Build the network of one stream.

    Raises OracleError when it has too many states, ProblemError when the model fails.
    """
    opened = [index for index, m in enumerate(problem.messages) if m.stream == stream and not m.sent]
    custom = CustomStream(problem, stream, list(range(len(opened))), problem.t_end)
    network, begin = _Network(), 0
    nodes = {custom.empty(): 0}
    for level in range(len(opened)):
        place = custom.place(level)
        found: dict[States, int] = {}
        for states, tail in nodes.items():
            before = custom.arrive(states, begin, place)
            network.arc(tail, network.node(found, before))
            network.arc(tail, network.node(found, custom.add(before, place)), sent=level)
        if network.nodes > MAX_NODES:
            model = type(problem.streams[stream].aggregation).__name__
            raise OracleError(
                f"stream {stream}: what {model} makes of its {len(opened)} messages has more than {MAX_NODES:,} states:"
                " ask for a shorter mission, or let tantamount states be equal"
            )
        nodes, begin = found, place + 1
    for states, tail in nodes.items():
        network.arc(tail, network.nodes, gain=custom.worth(states, begin)[0])
    return _part(network, opened, len(problem.messages))


def _part(network: _Network, opened: list[int], messages: int) -> Part:
    """Return the columns and rows: a row for each node, then one for what the arcs that send each message carry."""
    end, sent = network.nodes, np.array(network.sent, dtype=np.int64)
    column = messages + np.arange(len(sent))
    carried = end + 1 + np.arange(len(opened))
    supply = np.zeros(end + 1 + len(opened))
    supply[0], supply[end] = -1.0, 1.0
    sends = np.flatnonzero(sent >= 0)
    balance = [
        arcs(column, np.array(network.tail, dtype=np.int64), np.array(network.head, dtype=np.int64)),
        Entries(carried[sent[sends]], column[sends], np.ones(len(sends))),
        Entries(carried, np.array(opened, dtype=np.int64), -np.ones(len(opened))),
    ]
    return Part(
        gain=np.concatenate((np.zeros(messages), network.gain)),
        balance=joined(balance),
        supply=supply,
        skips=np.zeros(messages + len(sent), dtype=np.int64),
    )
