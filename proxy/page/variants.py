"""What the buttons do to specs, line by line, so that the way back stands in the files themselves.

*Paper* has the newest message count whatever it shows (Eq. 9): red that is gone is no loss. *Downsampling* has all
samples of a type count the same, so that each stream goes at the even rate for which there is room, as downsampling
does that is tuned to the channel.
"""

import re
from collections.abc import Callable

from proxy.errors import PushError
from proxy.page.specs import Files

WAS = "  # was, before the page changed it: "
PLAIN, PAPER, DOWNSAMPLED = "on", "paper", "downsampling"
_CURRENT = re.compile(r'\s*aggregation\s*=\s*["\']current["\']')
_SCALE = re.compile(r"\s*scale\s*=\s*(.*)")


def variant(name: str, files: Files) -> dict[str, str]:
    """Return the files as a variant has them, from any. Raises PushError where a line cannot be changed."""
    change = _CHANGES[name]
    return {file: _each(file, text, change) for file, text in files.items()}


def variant_of(files: Files) -> str:
    """Return the variant that files are."""
    changed = [line for text in files.values() for line in text.splitlines() if WAS in line]
    if not changed:
        return PLAIN
    return PAPER if any(_CURRENT.match(line.partition(WAS)[2]) for line in changed) else DOWNSAMPLED


def _each(file: str, text: str, change: Callable[[str], str | None]) -> str:
    lines = []
    for place, line in enumerate(text.split("\n"), start=1):
        _, mark, was = line.partition(WAS)
        plain = was if mark else line
        try:
            new = change(plain)
        except ValueError as error:
            raise PushError(f"{file}:{place}: {error}") from None
        lines.append(plain if new is None else f"{new}{WAS}{plain}")
    return "\n".join(lines)


def _paper(line: str) -> str | None:
    return 'aggregation = "most_recent"' if _CURRENT.match(line) else None


def _downsampled(line: str) -> str | None:
    found = _SCALE.match(line)
    if found is None:
        return None
    if found[1].startswith(('"""', "'''")):
        raise ValueError("a scale of several lines can only be changed in the editor")
    return 'scale = "1"'


_CHANGES: dict[str, Callable[[str], str | None]] = {
    PLAIN: lambda _line: None,
    PAPER: _paper,
    DOWNSAMPLED: _downsampled,
}
