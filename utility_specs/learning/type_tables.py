"""Writes the table of a type: what was found, with the reasons as comments, and what could matter commented out."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median, quantiles

from utility_specs.learning.candidates import Candidate, Found
from utility_specs.learning.outlook import best_method
from utility_specs.learning.patterns import Kind
from utility_specs.learning.toml_text import commented, counted, frequency, number, prose, rate, size, span, toml_string
from utility_specs.learning.worth import Coming, period, worth_of

MOST_FEATURES = 5
"""Features of a type that are proposed; others are named."""
MOST_NAMES = 8
"""Names of what was left out in a comment."""
PLAIN = 0.2
"""What varies by so much between 0 and 1 needs no range."""

UNREAD = (
    "These messages could not be read: that takes the package rosbags (Sendworthy's extra `ros2`), keys of rmw_zenoh,"
    ' and types of ROS 2 itself. For others write features of kind = "cdr" with their type and definition.'
)

_FORMATS = {
    "json": "JSON",
    "msgpack": "MessagePack",
    "image": "images",
    "cdr": "messages of ROS 2",
    "ros_image": "images of ROS 2",
    "text": "text",
    "raw": "bytes of unknown meaning",
}


@dataclass(frozen=True, slots=True)
class Learned:
    """A type as it will be written."""

    name: str
    kind: Kind
    found: Found
    coming: Coming


def type_table(each: Learned, duration: float) -> Iterator[str]:
    """Yield the lines of a type in traffic of some duration [s]."""
    kind, worth = each.kind, worth_of(each.kind.streams)
    yield from prose(_told(each, duration))
    yield "[[information_type]]"
    yield f"name = {toml_string(each.name)}"
    yield from _keys(kind.keys)
    yield commented("weight = 1.0", "SET WHAT MATTERS MOST HERE, against the other types")
    yield commented(f'aggregation = "{worth.aggregation}"', worth.combined)
    yield commented(f"utility = {worth.utility}", worth.why)
    if worth.schedule:
        yield commented(f"forecast.schedule = {worth.schedule}", "clearly at random")
    middle = median(look for stream in kind.streams for look in stream.sizes)
    yield commented(f'forecast.size = "{size(max(1.0, middle))}"', "what `sendworthy check` judges limits by")
    yield f"forecast.streams = {len(kind.streams)}"
    yield from _features(each.found)
    if kind.streams[0].format == "cdr" and not any(stream.shows for stream in kind.streams):
        yield from prose(UNREAD)


def _told(each: Learned, duration: float) -> str:
    """Say what was seen of a type."""
    streams = each.kind.streams
    sizes = sorted(look for stream in streams for look in stream.sizes)
    several = f"{counted(len(streams), 'stream')}, {'each ' if len(streams) > 1 else ''}"
    least, most = size(sizes[0]), size(sizes[-1])
    spread = size(median(sizes)) + ("" if least == most else f" ({least} to {most})")
    lasting = duration > 0.0 and each.coming != "once"
    speed = f", {rate(each.kind.bytes / duration)} in all" if lasting else ""
    return f"{each.name}: {several}{pace(each)} and {spread}{speed}: {_FORMATS[streams[0].format]}."


def pace(each: Learned) -> str:
    """Say how often a stream of a type comes, as a rule."""
    apart = period(each.kind.streams, each.coming)
    if each.coming == "once" or apart <= 0.0:
        return "once"
    manner = {"events": " at random", "random": " at random", "bursts": " in bursts"}.get(each.coming, "")
    return frequency(1.0 / apart) + manner


def _features(found: Found) -> Iterator[str]:
    shown, more = found.candidates[:MOST_FEATURES], found.candidates[MOST_FEATURES:]
    if shown:
        yield "# What varies in it, most of all first; to make it matter, uncomment a feature and a scale that uses it:"
    for each in shown:
        table = f"{{ {each.table}, default = {number(median(each.values))} }}"
        yield commented(f"#features.{each.name} = {table}", _range(each))
    if shown:
        yield commented(f'#scale = "{_scale(shown[0])}"', "up to 11 times the worth; any arithmetic will do")
        method, less = best_method(shown)
        if method != "last":
            yield commented(f'#forecast.features = "{method}"', f'errs {less * 100:.0f} % less than "last" here')
    if more:
        yield from prose(f"More that varies: {_listed([each.name for each in more])}.")
    if found.left_out:
        by_reason: dict[str, list[str]] = {}
        for path, why in found.left_out:
            by_reason.setdefault(why, []).append(path)
        yield from prose(
            "Left out: " + "; ".join(f"{_listed(paths)} ({why})" for why, paths in by_reason.items()) + "."
        )


def _scale(each: Candidate) -> str:
    """Return a scale from 1 where a feature was least to 11 where it was greatest."""
    low, high = min(each.values), max(each.values)
    if low >= 0.0 and high <= 1.0 and high - low >= PLAIN:
        return f"1 + 10 * {each.name}"
    offset = f"{each.name} {'-' if low >= 0.0 else '+'} {number(abs(low))}"
    above = each.name if float(number(low)) == 0.0 else f"({offset})"
    return f"1 + 10 * clamp({above} / {number(max(high - low, abs(high) * 1e-3))}, 0, 1)"


def _range(each: Candidate) -> str:
    """Say what was seen of a feature: everything, and where most of it is if that is much less."""
    values = each.values
    low, *_, high = quantiles(values, n=20) if len(values) > 1 else (values[0], values[0])
    least, most = min(values), max(values)
    usual = f", mostly {span(low, high)}" if low < high and 2.0 * (high - low) < most - least else ""
    return f"{span(least, most)}{usual}"


def _keys(keys: Sequence[str]) -> Iterator[str]:
    if len(keys) == 1:
        yield f"keys = [{toml_string(keys[0])}]"
        return
    yield "keys = ["
    yield from (f"    {toml_string(key)}," for key in keys)
    yield "]"


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more
