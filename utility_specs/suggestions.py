"""Hints for misspelt words, and values as the reader wrote them."""

from collections.abc import Iterable
from itertools import islice

LONGEST_QUOTE = 40
"""Characters of a wrong value that a message repeats."""

MOST_LISTED = 64
"""Known words that a hint lists: a team may have thousands of types."""

LONGEST_NUMBER = 64
"""Bits of the largest whole number that a message repeats; Python refuses to print really large ones."""


def quoted(word: str) -> str:
    """Return the word in quotes on one line, shortened when it is long."""
    line = "".join(c if c.isprintable() else "\ufffd" for c in word)
    return f'"{line}"' if len(line) <= LONGEST_QUOTE else f'"{line[: LONGEST_QUOTE - 1]}…"'


def listed(words: Iterable[str]) -> str:
    """Return the words in quotes, separated by commas, in the order given."""
    return ", ".join(map(quoted, words))


def hint(word: str, known: Iterable[str], what: str = "known") -> str:
    """Return ` (did you mean "…"?)` when a known word is close, else the known words, else nothing."""
    from difflib import get_close_matches

    words = {candidate.lower(): candidate for candidate in known}
    close = get_close_matches(word.lower()[:LONGEST_QUOTE], words, n=1)
    if close:
        return f" (did you mean {quoted(words[close[0]])}?)"
    more = f" and {len(words) - MOST_LISTED} more" if len(words) > MOST_LISTED else ""
    return f" ({what}: {listed(islice(words.values(), MOST_LISTED))}{more})" if words else ""


def described(value: object) -> str:
    """Return a TOML value as a message shows it: scalars as written, containers by what they are."""
    match value:
        case bool():
            return str(value).lower()
        case str():
            return quoted(value)
        case dict() | list() | tuple():
            return "a table" if isinstance(value, dict) else "an array"
        case int() if value.bit_length() > LONGEST_NUMBER:
            return "a huge number"
        case float():
            return repr(value)  # rounded, it might seem to be what is asked for
        case _:
            return str(value)
