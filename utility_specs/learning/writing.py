"""Writes a spec file: what was found, with the reasons as comments, and what could matter commented out.

A line that begins with `#` and no blank is TOML for the reader to uncomment, as in the sample configuration.
"""

from collections.abc import Iterator, Sequence
from itertools import accumulate
from statistics import median

from utility_specs import digests
from utility_specs.learning.candidates import candidates_of
from utility_specs.learning.naming import type_name
from utility_specs.learning.patterns import Kind
from utility_specs.learning.toml_text import counted, duration, prose, rate, rounded_up, size
from utility_specs.learning.traffic import WINDOW, Traffic
from utility_specs.learning.type_tables import Learned, pace, type_table
from utility_specs.learning.worth import coming
from utility_specs.schema import MOST_KEYS, MOST_TYPES
from utility_specs.toml_source import LARGEST_FILE, MOST_MARKS, marks

LARGEST = LARGEST_FILE - 28 * 1024
"""Bytes of all tables of types: what stands above them needs the rest."""
MARKS = 32
"""Signs of keys and values that are written above them."""
MARGIN = 2.0
"""The ceiling of the limit is so many times what was seen."""


def named(kinds: Sequence[Kind]) -> list[Learned]:
    """Give every kind a name, and look for what could matter in it; the one of most bytes first."""
    learned: list[Learned] = []
    for kind in sorted(kinds, key=lambda each: (each.yields, -each.bytes))[:MOST_TYPES]:
        name = type_name(kind.words, kind.telling, {each.name for each in learned})
        learned.append(Learned(name, kind, candidates_of(kind.streams), coming(kind.streams)))
    return learned


def spec_file(traffic: Traffic, kinds: Sequence[Kind], robots: Sequence[str], notes: Sequence[str]) -> str:
    """Return the file as text; `notes` are said at its top."""
    types = named(kinds)
    tables = ["\n".join(type_table(each, traffic.duration)) for each in types]
    fitting = max(1, _fitting(types, tables))
    if fitting < len(kinds):
        notes = [*notes, f"Left out: {len(kinds) - fitting} of the types, those of fewest bytes."]
    head = [*_head(traffic, types[:fitting], notes), "", "version = 1", "", *_constraint(traffic, types, robots)]
    return "\n\n".join(["\n".join(head), *tables[:fitting]]) + "\n"


def _fitting(types: Sequence[Learned], tables: Sequence[str]) -> int:
    """Return how many of the types, from the first on, a file has room for."""
    taken = zip(
        accumulate(len(table.encode()) for table in tables),
        accumulate(map(marks, tables)),
        accumulate(len(each.kind.keys) for each in types),
        strict=True,
    )
    return sum(size <= LARGEST and signs <= MOST_MARKS - MARKS and keys <= MOST_KEYS for size, signs, keys in taken)


def _head(traffic: Traffic, types: Sequence[Learned], notes: Sequence[str]) -> Iterator[str]:
    streams = counted(len(traffic.streams), "stream")
    seen = f"{counted(traffic.count, 'sample')} in {streams}, {_seconds(traffic)}, {size(traffic.bytes)} in all"
    yield f"# Learned by `sendworthy learn` from what was seen: {seen}."
    yield "#"
    yield from _rows(types, traffic)
    yield "#"
    yield "# How much there is of everything was measured. What matters only you know:"
    yield "#   1. weight: what matters most; all types have 1.0 now."
    yield "#   2. scale: which samples of a type matter most, by the features that are commented out."
    yield "#   3. limit: what the channel carries."
    yield "# Then `sendworthy check` the file, and fly it with `sendworthy mode shadow` at first."
    for note in notes:
        yield "#"
        yield from prose(note)


def _rows(types: Sequence[Learned], traffic: Traffic) -> Iterator[str]:
    """Yield a table of all types."""
    table = [("type", "streams", "each", "size", "of all bytes")]
    for each in types:
        streams, part = each.kind.streams, 100.0 * each.kind.bytes / max(1, traffic.bytes)
        middle = size(median(look for stream in streams for look in stream.sizes))
        table.append((each.name, str(len(streams)), pace(each), middle, f"{float(f'{part:.2g}'):g} %"))
    widths = [max(len(row[place]) for row in table) for place in range(len(table[0]))]
    for row in table:
        yield "#   " + "   ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


def _constraint(traffic: Traffic, types: Sequence[Learned], robots: Sequence[str]) -> Iterator[str]:
    """Yield a limit that lets pass what was seen, and follows the channel where that is less."""
    copies = max(1, (len(robots) or max(len(each.kind.streams) for each in types)) - 1)
    usual, most = traffic.rate(0.5), traffic.rate(1.0)
    margin, least = MARGIN * most * copies, digests.least_limit(max(digests.TEAM, len(robots)))
    ceiling, guess = rounded_up(max(margin, least)), rounded_up(usual * copies)
    beside = f" or, as is more here, to {rate(ceiling)}: room beside what daemons tell each other" * (margin < least)
    yield from prose(
        f"SET THE LIMIT. What was seen takes {rate(usual)} as a rule and {rate(most)} at most in {WINDOW:g} s, in one"
        f" copy of each sample; in unicast each robot that wants it costs one, up to {copies} here."
    )
    yield from prose(
        f"As it stands, the limit follows the channel, up to {MARGIN:g} times that{beside}. If you know what the"
        " channel can carry, for all robots, write 90 % of that and no ceiling;"
        f' limit = "{rate(guess)}" is what is usual here.'
    )
    yield from ("[[constraint]]", 'kind = "throughput"', 'limit = "adaptive"', f'ceiling = "{rate(ceiling)}"')
    yield f"window = {WINDOW:g}"


def _seconds(traffic: Traffic) -> str:
    return duration(traffic.duration) if traffic.duration > 0.0 else "at one moment"
