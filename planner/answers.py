"""From what a search found, levels of the tree, to the plan that it answers with."""

from collections.abc import Sequence

from planner.search import Plan
from planner.tables import Tables


def answer(
    tables: Tables, sends: Sequence[int], opposite: Sequence[int] | None, *, iterations: int, nodes: int
) -> Plan:
    """Return the plan that sends the levels `sends`, beside the best that decides the current message otherwise."""
    taken = _entries(tables, sends)
    other = None if opposite is None else _entries(tables, opposite)
    aim = tables.aim
    return Plan(
        send=tables.current in sends,
        sends=tuple(int(tables.message[level]) for level in sends),
        utility=tables.gains.facts + float(tables.gains.gain[taken].sum()),
        opposite=None if other is None else tables.gains.facts + float(tables.gains.gain[other].sum()),
        iterations=iterations,
        nodes=nodes,
        lead=None if other is None else float(aim[taken].sum() - aim[other].sum()),
    )


def _entries(tables: Tables, sends: Sequence[int]) -> list[int]:
    """Return where the gains of these levels, in order, stand in the tables."""
    gains = tables.gains
    state = [0] * tables.streams
    entries = []
    for level in sends:
        stream = gains.stream[level]
        entries.append(int(gains.start[level]) + state[stream])
        state[stream] = int(gains.number[level]) + 1
    return entries
