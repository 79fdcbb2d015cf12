"""A mission as robots fly it: what applications publish, who wants it, and specs as an operator would write them."""

from collections.abc import Iterator
from itertools import groupby
from statistics import fmean

from studies.bench.format import Mission, StreamTable
from studies.bench.utilities import spec_of
from studies.simulation import missions
from studies.simulation.conditions import Conditions
from studies.simulation.missions import SLACK, specs_of
from studies.simulation.records import Frame

EVERYTHING = ("**",)


def operator(mission: Mission) -> str:
    """Return what the operator is called, who sends nothing: a name that no robot has."""
    name = "operator"
    while name in mission.robots:
        name += "-"
    return name


def flown(mission: Mission) -> missions.Mission:
    """Return the mission for a flight: all robots and an operator want everything, and all is broadcast."""
    interests = dict.fromkeys((*mission.robots, operator(mission)), EVERYTHING)
    frames = tuple(
        Frame(
            mission.streams[row.stream].robot,
            mission.streams[row.stream].key,
            row.t_gen,
            row.size,
            {"scale": row.scale} if _scaled(mission) else {},
        )
        for row in mission.rows
    )
    specs = specs_of("\n\n".join((*_limits(mission), *_types(mission))))
    limit = mission.problem.constraints[0].limit
    return missions.Mission(mission.problem, frames, specs, interests, limit, limit)


def _scaled(mission: Mission) -> bool:
    return "scale" in mission.head.columns


def _limits(mission: Mission) -> Iterator[str]:
    """Yield the limits. A daemon takes what it tells others from them, which a limit of messages does not count.

    So where samples are equally large such a limit stands in bytes, with room for that beside it, as in the study.
    """
    sizes = {row.size for row in mission.rows}
    for limit in mission.head.limits:
        if limit.kind == "messages" and len(sizes) > 1:
            yield f'[[constraint]]\nkind = "messages"\nlimit = {int(limit.limit)}\nwindow = {limit.window!r}'
            continue
        room = limit.limit
        if limit.kind == "messages":
            how = Conditions(transport="broadcast", robots=len(mission.robots) + 1, window=limit.window)
            room = how.gross((limit.limit + SLACK) * max(sizes))
        yield f'[[constraint]]\nkind = "throughput"\nlimit = "{room / limit.window!r} B/s"\nwindow = {limit.window!r}'


def _types(mission: Mission) -> Iterator[str]:
    """Yield the information types: streams that are alike are of one."""
    slopes: dict[int, list[float]] = {}
    for row in mission.rows:
        if row.slope is not None:
            slopes.setdefault(row.stream, []).append(row.slope)
    alike = [(_worth(table, slopes.get(number)), table.key) for number, table in enumerate(mission.streams)]
    scale = (
        'scale = "scale"\nfeatures.scale = { kind = "json", path = "scale", default = 1 }' if _scaled(mission) else ""
    )
    for number, (worth, streams) in enumerate(groupby(sorted(alike), key=lambda each: each[0])):
        keys = ", ".join(f'"{key}"' for key in dict.fromkeys(key for _, key in streams))
        yield f'[[information_type]]\nname = "type-{number}"\nkeys = [{keys}]\n{worth}\n{scale}'


def _worth(table: StreamTable, slopes: list[float] | None) -> str:
    """Write what samples of a stream are worth; of many slopes their mean."""
    utility = dict(table.utility) if slopes is None else table.utility | {"slope": fmean(slopes)}
    return f'aggregation = "{table.aggregation}"\nweight = {table.weight!r}\nutility = {spec_of(utility)}'
