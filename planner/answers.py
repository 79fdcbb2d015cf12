"""From what a search found, levels of the tree, to the plan that it answers with and what explains it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from planner.search import Plan
from planner.tables import Tables

ROUNDING = 1e-8
"""What rounding may add to a bound, as a part of it."""


@dataclass(frozen=True, slots=True)
class Found:
    """What a search found: the levels that its plan sends, and those of the best plan that decides otherwise.

    No plan exceeds `bound`; None when that is not known. `asked[j]` is what column j of the checks charges for sending
    the current message within the window. Both are of what the search maximises [utility·s].
    """

    sends: Sequence[int]
    opposite: Sequence[int] | None
    bound: float | None
    asked: Sequence[float]
    nodes: int


def answer(tables: Tables, found: Found, iterations: int) -> Plan:
    """Return the plan, beside the best that decides the current message otherwise."""
    send, message = tables.current in found.sends, tables.message
    aim, value = _worth(tables, found.sends)
    other = None if found.opposite is None else _worth(tables, found.opposite)
    spared = _spared(tables, found.sends if send else found.opposite)
    prices = tables.charged()
    for k, asked in zip(tables.constraint, found.asked, strict=True):
        prices[k] += asked
    too_much = () if send else tables.overfilled([*found.sends, tables.current])
    return Plan(
        send=send,
        sends=tuple(message[level] for level in found.sends),
        utility=value,
        opposite=None if other is None else other[1],
        iterations=iterations,
        nodes=found.nodes,
        lead=None if other is None else aim - other[0],
        gap=_gap(tables, found.bound, aim),
        prices=tuple(prices),
        binding=tuple(
            constraint.name for k, constraint in enumerate(tables.problem.constraints) if prices[k] > 0 or k in too_much
        ),
        earns=None if spared is None else (aim if send or other is None else other[0]) - spared[0],
        spared=None if spared is None else spared[1],
    )


def _spared(tables: Tables, sends: Sequence[int] | None) -> tuple[float, float] | None:
    """Return what a plan that sends the current message is worth without it; None where there is no such plan."""
    if sends is None or tables.current not in sends:
        return None
    return _worth(tables, [level for level in sends if level != tables.current])


def _gap(tables: Tables, bound: float | None, aim: float) -> float | None:
    """Return by how much a plan may exceed the one that is worth `aim`; what rounding adds is nothing."""
    if bound is None or math.isinf(bound) or not tables.exact:
        return None
    gap = bound - aim
    return gap if gap > ROUNDING * abs(bound) else 0.0


def _worth(tables: Tables, sends: Sequence[int]) -> tuple[float, float]:
    """Return what the search maximises, and U, of the plan that sends these levels, in order [utility·s]."""
    if not tables.closed:
        return _walked(tables, sends), _utility(tables, sends)
    aim, value = tables.worth(sends)
    return aim, value if tables.exact else _utility(tables, sends)


def _walked(tables: Tables, sends: Sequence[int]) -> float:
    """Return the same where a stream is open ended and the table does not say it."""
    from planner.python_engine.path import Path

    path, aim = Path(tables), tables.gains.aim_facts
    for level in sends:  # what is dropped changes no gain
        aim += path.gain(level)
        path.step(level, send=True)
    return aim


def _utility(tables: Tables, sends: Sequence[int]) -> float:
    """Return U of the plan that sends these levels, by the definition [utility·s]."""
    from planner.definition import utility

    return utility(tables.problem, [tables.message[level] for level in sends])
