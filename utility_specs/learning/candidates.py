"""What could matter in the samples of a type: the numbers in them that vary, and are no counters and no times."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

from utility_specs.learning.formats import ros_type
from utility_specs.learning.image_features import image_table
from utility_specs.learning.leaves import Leaf, Shown
from utility_specs.learning.naming import feature_name
from utility_specs.learning.patterns import ROBOT
from utility_specs.learning.stream import Stream
from utility_specs.learning.toml_text import toml_string

FEW = 4
"""With fewer values nothing counts up by more than chance."""
MOST_WORDS = 5
"""Texts of which there are more are names, not states."""
SLIGHT = 1e-3
"""What varies by less than this part of it is as good as constant."""
FAINT = 0.01
"""What images show, from 0 to 1, is as good as constant when it varies by less."""
CLOCKS = (1.0, 1e3, 1e6, 1e9)
"""Units of clocks in a second."""
LONG_AGO = 600.0
"""What goes with the time is a clock when it began so long ago: a robot may move at 1 m/s [s]."""
STAMPS = {"stamp", "timestamp", "nanosec", "nsec", "nsecs"}

Series = list[tuple[float, float]]
"""When [s] which value was seen."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A feature that could matter: its `table` without braces and default, and what was seen of it in each stream."""

    name: str
    table: str
    series: tuple[Series, ...]

    @property
    def values(self) -> list[float]:
        """All values seen."""
        return [value for each in self.series for _, value in each]

    @property
    def variation(self) -> float:
        """By how much it varies, from 0 to 1: its mean deviation against the size of its values."""
        middle = fmean(self.values)
        deviation = fmean([abs(value - middle) for value in self.values])
        return deviation / (deviation + abs(middle)) if deviation else 0.0


@dataclass(frozen=True, slots=True)
class Found:
    """What was found in the samples of a type: candidates, what varies most first, and what is none, by the reason."""

    candidates: tuple[Candidate, ...]
    left_out: tuple[tuple[str, str], ...]


def candidates_of(streams: Sequence[Stream]) -> Found:
    """Look at all numbers and words that the streams show."""
    candidates: list[Candidate] = []
    left_out: list[tuple[str, str]] = []
    for shown in dict.fromkeys(each for stream in streams for each in stream.shows):
        series = [each for stream in streams if (each := stream.series(shown))]
        word, numbers = _as_numbers(series)
        why = _no_candidate(shown, numbers)
        if why and not (isinstance(shown, Leaf) and shown.reduce == "length"):
            left_out.append((_called(shown), why))
        elif not why:
            name = _name(shown, word, {ROBOT, *(each.name for each in candidates)})
            candidates.append(Candidate(name, _table(shown, word, streams[0]), tuple(numbers)))
    candidates.sort(key=lambda each: -each.variation)
    return Found(tuple(candidates), tuple(left_out))


def _as_numbers(series: Sequence[list[tuple[float, float | str]]]) -> tuple[str | None, list[Series]]:
    """Return numbers as they are; of texts the least common, and where it stands (1) or not (0)."""
    texts = Counter(value for each in series for _, value in each if isinstance(value, str))
    if not texts:
        return None, [[(t, value) for t, value in each if isinstance(value, float)] for each in series]
    if len(texts) > MOST_WORDS:
        return "", []
    word = min(sorted(texts), key=lambda text: texts[text])
    return word, [[(t, float(value == word)) for t, value in each] for each in series]


def _no_candidate(shown: Shown, series: Sequence[Series]) -> str:
    """Return why numbers are no candidate; nothing if they are one."""
    least = FAINT if isinstance(shown, str) else 0.0
    reasons = {_idle(_called(shown), each, least) for each in series}
    if not reasons:
        return "text"
    for reason in ("", "counts", "time"):
        if reason in reasons:
            return reason
    return "constant"


def _idle(path: str, series: Series, least: float) -> str:
    values = [value for _, value in series]
    varies = max(values) - min(values)
    if varies and (STAMPS & set(path.lower().replace("[", ".").split(".")) or _is_time(series)):
        return "time"
    if varies <= max(least, SLIGHT * abs(fmean(values))):
        return "constant"
    steps = [b - a for a, b in pairwise(values)]
    whole = all(value.is_integer() for value in values)
    return "counts" if whole and len(values) >= FEW and min(steps) > 0.0 else ""


def _is_time(series: Series) -> bool:
    """Whether numbers go with the time, in a unit of clocks."""
    (begin, first), (end, last) = series[0], series[-1]
    if len(series) < FEW or end <= begin or any(b < a for (_, a), (_, b) in pairwise(series)):
        return False
    pace = (last - first) / (end - begin)
    unit = min(CLOCKS, key=lambda clock: abs(pace / clock - 1.0))
    off = [abs((value - first) / unit - (t - begin)) for t, value in series]
    return max(off) <= 0.05 * (end - begin) and abs(first) / unit > LONG_AGO


def _called(shown: Shown) -> str:
    return shown.path if isinstance(shown, Leaf) else shown


def _name(shown: Shown, word: str | None, taken: set[str]) -> str:
    if isinstance(shown, str):
        return shown
    return feature_name(shown.path, word or shown.reduce or "", taken)


def _table(shown: Shown, word: str | None, stream: Stream) -> str:
    """Return the table of a feature, without braces."""
    ros = ros_type(stream.key)
    if isinstance(shown, str):
        return image_table(shown, ros if stream.format == "ros_image" else None)
    parts = [f'kind = "{stream.format}"']
    if stream.format == "cdr":
        parts += [f"type = {toml_string(ros or '')}", f"field = {toml_string(shown.path)}"]
    elif shown.path:
        parts.append(f"path = {toml_string(shown.path)}")
    parts += [f"equals = {toml_string(word)}"] if word else []
    return ", ".join(parts + ([f'reduce = "{shown.reduce}"'] if shown.reduce else []))
