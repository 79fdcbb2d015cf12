"""Numbers, quantities, texts and comments as people write them in specs."""

from collections.abc import Iterator
from math import ceil, floor, log10
from textwrap import wrap

COMMENTS = 50
"""Comments behind values begin in this column."""
WIDTH = 118


def toml_string(text: str) -> str:
    """Return a basic string of TOML."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(sign if sign.isprintable() else f"\\U{ord(sign):08X}" for sign in escaped) + '"'


def number(value: float, digits: int = 3) -> str:
    """Return a number with so many digits that count."""
    rounded = float(f"{value:.{digits}g}")
    return str(int(rounded)) if rounded.is_integer() and abs(rounded) < 1e6 else repr(rounded)


def duration(seconds: float) -> str:
    """Return a duration with one or two digits that count, as specs have it."""
    for unit, factor in (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)):
        if float(f"{seconds:.2g}") >= factor:
            return f"{float(f'{seconds / factor:.2g}'):g} {unit}"
    return f"{max(1.0, float(f'{seconds * 1e6:.2g}')):g} us"


def frequency(rate: float) -> str:
    """Return a frequency, or where it is less than one in two seconds how far apart samples are."""
    return f"{rate:.2g} Hz" if rate >= 0.5 else f"every {duration(1.0 / rate)}"


def span(low: float, high: float) -> str:
    """Return from where to where numbers go, with as many digits as it takes to tell the ends apart."""
    digits = next((n for n in range(2, 12) if number(low, n) != number(high, n)), 12)
    return f"{number(low, digits)} to {number(high, digits)}"


def size(count: float) -> str:
    """Return a number of bytes."""
    return f"{count:.0f} B" if count < 1000 else _prefixed(count, "B")


def rate(speed: float) -> str:
    """Return a rate in bits per second of one in bytes per second."""
    return _prefixed(8.0 * speed, "bit/s")


def rounded_up(speed: float) -> float:
    """Return the next rate [B/s] above one that is a round number of bits per second, 1 kbit/s at least."""
    bits = max(8.0 * speed, 1e3)
    step = 10.0 ** floor(log10(bits)) / 2.0
    return ceil(bits / step) * step / 8.0


def _prefixed(value: float, unit: str) -> str:
    for prefix, factor in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if float(f"{value:.2g}") >= factor:
            return f"{float(f'{value / factor:.2g}'):g} {prefix}{unit}"
    return f"{float(f'{value:.2g}'):g} {unit}"


def commented(line: str, comment: str) -> str:
    """Return a line with a comment behind it."""
    return f"{line.ljust(COMMENTS)}  # {comment}" if len(line) <= COMMENTS else f"{line}  # {comment}"


def prose(text: str) -> Iterator[str]:
    """Yield the lines of a comment."""
    yield from (f"# {line}" for line in wrap(text, WIDTH, break_long_words=False, break_on_hyphens=False))


def counted(count: int, one: str, many: str = "") -> str:
    """Return a number and what is counted."""
    return f"{count} {one if count == 1 else many or one + 's'}"
