"""Missions as files: JSON lines, as `README.md` describes them. The mission comes first, then streams, then samples.

Everything is checked when it is read. What is wrong is told by file, line and key.
"""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from planner import Aggregation, Constraint, Linear, Message, MessageUtility, Problem, Stream
from planner.errors import ProblemError
from planner.measures import Measure, Messages, Throughput
from studies.bench.errors import BenchError
from studies.bench.utilities import utility_of

FORMAT: Literal["sendworthy-bench 1"] = "sendworthy-bench 1"
"""What the first line of a file says; what would be misread has a greater number."""
FIRST = ("t_gen", "stream", "size")
"""The columns that all samples have, in order."""
FURTHER = ("scale", "slope")
"""Those that may follow."""
AGGREGATIONS = tuple(each.value for each in Aggregation)

Model = TypeVar("Model", bound=BaseModel)
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
AtLeastZero = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Line = Callable[[str, str], BenchError]
"""Makes an error of a key and what is wrong with it."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class LimitTable(_Table):
    """What may be sent in any `window` [s]: `limit` bytes, or samples."""

    kind: Literal["throughput", "messages"]
    limit: Positive
    window: Positive

    @property
    def measure(self) -> Measure:
        """As the planner has it."""
        if self.kind == "messages":
            return Messages(self.limit, self.window)
        return Throughput(self.limit / self.window, self.window)


class Head(_Table):
    """The first line. Times are seconds; `bound` and `all` are utility·s."""

    format: Literal["sendworthy-bench 1"]
    name: str = Field(min_length=1)
    about: str
    seconds: Positive
    warm_up: AtLeastZero
    latency: AtLeastZero
    loss: float = Field(ge=0.0, lt=1.0)
    seed: int = Field(ge=0)
    limits: tuple[LimitTable, ...] = Field(min_length=1, strict=False)
    columns: tuple[str, ...] = Field(strict=False)
    bound: Positive
    all: Positive


class StreamTable(_Table):
    """The samples of one key: who has them, how they combine and fade."""

    robot: str = Field(min_length=1)
    key: str = Field(min_length=1)
    aggregation: str
    weight: Positive
    utility: dict[str, Any]


class Row(NamedTuple):
    """A sample; `slope` replaces that of its stream's linear utility, where it is known [1/s]."""

    t_gen: float
    stream: int
    size: int
    scale: float = 1.0
    slope: float | None = None


@dataclass(frozen=True)
class Mission:
    """What is flown: streams, samples in the order of their generation, limits and the way to who wants them."""

    head: Head
    streams: tuple[StreamTable, ...]
    rows: tuple[Row, ...]

    @property
    def robots(self) -> tuple[str, ...]:
        """All robots, in the order of their first stream."""
        return tuple(dict.fromkeys(stream.robot for stream in self.streams))

    @property
    def limits(self) -> tuple[Measure, ...]:
        """The limits as the planner measures them."""
        return tuple(table.measure for table in self.head.limits)

    @cached_property
    def problem(self) -> Problem:
        """All samples as one problem of the planner, open, each on its way for the latency."""
        utilities = [utility_of(table.utility) for table in self.streams]
        numbers = {robot: number for number, robot in enumerate(self.robots)}
        limits = self.limits
        messages = []
        for row in self.rows:
            utility = _sloped(utilities[row.stream], row.slope)
            scale = self.streams[row.stream].weight * row.scale
            use = tuple(limit.use(row.size, 1, own=True) for limit in limits)
            t_rcv = row.t_gen + self.head.latency
            messages.append(Message(row.stream, row.t_gen, row.t_gen, t_rcv, utility, scale, use))
        return Problem(
            tuple(Stream(numbers[table.robot], Aggregation(table.aggregation)) for table in self.streams),
            tuple(messages),
            0,
            tuple(_constraint(self.head.limits, number) for number in range(len(limits))),
            (),
            t_start=0.0,
            t_end=self.head.seconds,
            goes_on=False,
        )


def read(path: Path) -> Mission:
    """Read a mission. Raises BenchError for what is none, by line and key."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is no text"
        raise BenchError(f"{path} cannot be read: {why}") from None
    if not lines:
        raise BenchError(f"{path} is empty: its first line should describe a mission")
    found = enumerate(lines, start=1)
    number, first = next(found)
    head = _head(_parsed(path, number, first), _at(path, number))
    streams: list[StreamTable] = []
    rows: list[Row] = []
    for number, line in found:
        at, given = _at(path, number), _parsed(path, number, line)
        if isinstance(given, list):
            rows.append(_row(given, head, streams, rows, at))
        elif rows:
            raise at("", "a stream after the first sample; all streams come before")
        else:
            streams.append(_stream(given, at))
    if not rows:
        raise BenchError(f"{path}: it has no samples")
    return Mission(head, tuple(streams), tuple(rows))


def text_of(mission: Mission) -> str:
    """Write a mission as its file has it."""
    return "".join(f"{line}\n" for line in _lines(mission))


def _lines(mission: Mission) -> Iterator[str]:
    yield _dumped(mission.head.model_dump())
    yield from (_dumped(stream.model_dump()) for stream in mission.streams)
    for row in mission.rows:
        yield _dumped([getattr(row, column) for column in mission.head.columns])


def _dumped(given: Any) -> str:
    return json.dumps(given, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _parsed(path: Path, number: int, line: str) -> Any:
    try:
        return json.loads(line)
    except json.JSONDecodeError as error:
        raise BenchError(f"{path}:{number}: no JSON: {error.msg} (column {error.colno})") from None


def _at(path: Path, number: int) -> Line:
    """Return what makes errors of a line."""
    return lambda key, what: BenchError(f"{path}:{number}: {key}{': ' if key else ''}{what}")


def _head(given: Any, at: Line) -> Head:
    if not isinstance(given, dict) or given.get("format") != FORMAT:
        raise at("format", f'the first line of a mission has "{FORMAT}" here')
    head = _checked(Head, given, at)
    if head.columns[: len(FIRST)] != FIRST:
        raise at("columns", f"they begin with {', '.join(FIRST)}")
    for column in head.columns[len(FIRST) :]:
        if column not in FURTHER or head.columns.count(column) > 1:
            raise at(
                "columns", f"after {', '.join(FIRST)} each of {', '.join(FURTHER)} may follow once, not {column!r}"
            )
    for number, limit in enumerate(head.limits):
        if limit.kind == "messages" and limit.limit != int(limit.limit):
            raise at(f"limits.{number}.limit", f"a whole number of messages, not {limit.limit:g}")
    if head.warm_up >= head.seconds:
        raise at("warm_up", "it is less than seconds")
    return head


def _stream(given: Any, at: Line) -> StreamTable:
    table = _checked(StreamTable, given, at)
    if table.aggregation not in AGGREGATIONS:
        raise at("aggregation", f"one of {', '.join(AGGREGATIONS)}, not {table.aggregation!r}")
    try:
        utility_of(table.utility)
    except (ProblemError, ValueError) as error:
        raise at("utility", str(error)) from None
    return table


def _row(given: list[Any], head: Head, streams: Sequence[StreamTable], rows: Sequence[Row], at: Line) -> Row:
    """Check a sample against what came before it."""
    if len(given) != len(head.columns):
        raise at("", f"a sample has {len(head.columns)} numbers ({', '.join(head.columns)}), not {len(given)}")
    for column, value in zip(head.columns, given, strict=True):
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value) or value < 0:
            raise at(column, f"a number from 0 on, not {json.dumps(value)}")
    row = Row(**dict(zip(head.columns, given, strict=True)))
    if not isinstance(row.stream, int) or row.stream >= len(streams):
        raise at("stream", f"there are streams 0 to {len(streams) - 1}, not {row.stream}")
    if not isinstance(row.size, int):
        raise at("size", f"a whole number of bytes, not {row.size}")
    if row.t_gen >= head.seconds:
        raise at("t_gen", f"the mission ends at {head.seconds:g} s")
    if rows and row.t_gen < rows[-1].t_gen:
        raise at("t_gen", f"{row.t_gen} s comes after {rows[-1].t_gen} s: samples stand in the order of their times")
    if row.slope is not None and (streams[row.stream].utility["kind"] != "linear" or row.slope == 0.0):
        raise at("slope", "a number above 0, of a stream whose utility is linear")
    return row


def _checked(model: type[Model], given: Any, at: Line) -> Model:
    try:
        return model.model_validate(given)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        raise at(key, first["msg"][:1].lower() + first["msg"][1:]) from None


def _sloped(utility: MessageUtility, slope: float | None) -> MessageUtility:
    return utility if slope is None or not isinstance(utility, Linear) else Linear(utility.u0, slope)


def _constraint(limits: Sequence[LimitTable], number: int) -> Constraint:
    """Return a limit as a constraint, with a name of its own."""
    table = limits[number]
    alike = sum(each.kind == table.kind for each in limits)
    return Constraint(table.kind if alike == 1 else f"{table.kind}-{number}", table.window, table.limit)
