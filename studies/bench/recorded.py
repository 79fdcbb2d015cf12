"""A mission of what daemons recorded, or of traffic that was imported: what applications published, and the specs."""

from collections.abc import Sequence
from pathlib import Path

from planner import Aggregation, Linear
from planner.measures import Measure, Messages, Throughput
from proxy.recording.reading import RecordingReader
from studies.bench.errors import BenchError
from studies.bench.format import FIRST, FORMAT, Head, LimitTable, Mission, Row, StreamTable
from studies.bench.generated import NUMBER, PLACEHOLDER, SEED, TIME
from studies.bench.utilities import table_of
from studies.bench.worth import bounded
from studies.given import once
from studies.replay.mission import Mission as Flown
from studies.replay.outcomes import Outcomes
from studies.replay.policies import enter_all
from studies.replay.recordings import Recordings, Survey
from studies.replay.specs import specs_of
from utility_specs import Specs
from utility_specs.loader import load_set

WARM_UP = 5.0
"""Flown but not scored [s], or a fifth of a short recording."""
AFTER = 0.1
"""A mission ends so long after its last sample [s]."""


def of_recording(
    files: Sequence[Path], specs: Sequence[Path] | None, name: str, *, about: str | None = None, latency: float
) -> Mission:
    """Make a mission of all parts of a recording, or of those of several robots, at this latency [s].

    Raises BenchError, RecordingError, ReplayError, SpecsError or OSError.
    """
    recordings = Recordings(tuple(RecordingReader(path) for path in once(files)))
    survey = recordings.survey()
    flown = Flown(_specs(survey, specs), tuple(sorted(survey.samples)), latency)
    outcomes = enter_all(flown, recordings.told(frozenset(flown.robots)), survey.first)
    planned = [number for number, stream in enumerate(outcomes.streams) if stream.planned]
    if not planned:
        raise BenchError("the specs cover no key of this traffic")
    limits = tuple(_limit(spec.measure) for spec in flown.specs.constraints)
    if not limits:
        raise BenchError("the specs set no limit, so there is nothing to decide")
    rows, columns = _rows(outcomes, planned)
    seconds = round(rows[-1].t_gen + AFTER, TIME)
    head = Head(
        format=FORMAT,
        name=name,
        about=about or f"recorded: {', '.join(flown.robots)}",
        seconds=seconds,
        warm_up=min(WARM_UP, seconds / 5),
        latency=latency,
        loss=0.0,
        seed=SEED,
        limits=limits,
        columns=columns,
        bound=PLACEHOLDER,
        all=PLACEHOLDER,
    )
    streams = tuple(_stream(outcomes, number) for number in planned)
    return bounded(Mission(head, streams, rows))


def _specs(survey: Survey, files: Sequence[Path] | None) -> Specs:
    if files:
        return load_set(files).specs
    if survey.specs is None:
        raise BenchError("what its samples are worth is not in the recording: name utility specs with --specs")
    return specs_of(survey.specs)


def _limit(measure: Measure) -> LimitTable:
    if isinstance(measure, Messages):
        return LimitTable(kind="messages", limit=float(measure.count), window=measure.window)
    if isinstance(measure, Throughput):
        return LimitTable(kind="throughput", limit=measure.limit, window=measure.window)
    raise BenchError(f"a mission file has no limit of the kind {measure.kind}; name other specs with --specs")


def _rows(outcomes: Outcomes, planned: Sequence[int]) -> tuple[tuple[Row, ...], tuple[str, ...]]:
    """Return the samples of these streams from the first one on, and their columns."""
    columns, place = outcomes.columns(), {number: at for at, number in enumerate(planned)}
    weights = {number: _weight(outcomes, number) for number in planned}
    rows = []
    for index, number in enumerate(columns.stream.tolist()):
        if number not in place:
            continue
        utility = outcomes.utility(int(columns.worth[index]))
        rows.append(
            Row(
                round(float(columns.t[index]), TIME),
                place[number],
                int(columns.size[index]),
                round(float(columns.scale[index]) / weights[number], NUMBER),
                round(utility.slope, NUMBER) if isinstance(utility, Linear) else None,
            )
        )
    rows.sort(key=lambda row: row.t_gen)
    varied = len({(row.stream, row.slope) for row in rows}) > len(planned)
    if varied and any(row.slope is None for row in rows):
        raise BenchError("a mission file has utilities whose parameters follow features only where all are linear")
    scaled = any(row.scale != 1.0 for row in rows)
    further = [name for name, wanted in (("scale", scaled), ("slope", varied)) if wanted]
    kept = rows if varied else [row._replace(slope=None) for row in rows]
    return tuple(kept), (*FIRST, *further)


def _weight(outcomes: Outcomes, number: int) -> float:
    covering = outcomes.streams[number].covering
    return 1.0 if covering is None else float(covering.weight)


def _stream(outcomes: Outcomes, number: int) -> StreamTable:
    stream, columns = outcomes.streams[number], outcomes.columns()
    kinds = {int(worth) for worth, of in zip(columns.worth, columns.stream, strict=True) if of == number}
    utilities = [outcomes.utility(kind) for kind in sorted(kinds)]
    if len(set(utilities)) > 1 and not isinstance(utilities[0], Linear):
        raise BenchError(f"{stream.key}: its utility follows features, which a mission file has of linear ones alone")
    if not isinstance(stream.aggregation, Aggregation):
        raise BenchError(f"{stream.key}: a mission file has no aggregation of its own")
    try:
        utility = table_of(utilities[0])
    except ValueError as error:
        raise BenchError(f"{stream.key}: {error}") from None
    robot = outcomes.mission.robots[stream.robot]
    return StreamTable(
        robot=robot,
        key=stream.key,
        aggregation=stream.aggregation.value,
        weight=_weight(outcomes, number),
        utility=utility,
    )
