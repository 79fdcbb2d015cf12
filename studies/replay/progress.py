"""How far a replay is, for whoever waits: one line that changes in a terminal, else a line now and then."""

import sys
from collections.abc import Callable
from time import monotonic

IN_TERMINAL, ELSEWHERE = 0.2, 10.0
"""So long lies between two lines [s]."""


class Progress:
    """Prints to standard error; `text(done)` words it."""

    def __init__(self, text: Callable[[float], str]) -> None:
        self._text = text
        self._terminal = sys.stderr.isatty()
        self._due = monotonic() + (IN_TERMINAL if self._terminal else ELSEWHERE)
        self._shown = False

    def __call__(self, done: float) -> None:
        """So much is done."""
        now = monotonic()
        if now < self._due:
            return
        self._due = now + (IN_TERMINAL if self._terminal else ELSEWHERE)
        self._shown = True
        print(
            f"\r{self._text(done)}  " if self._terminal else self._text(done),
            end="" if self._terminal else "\n",
            file=sys.stderr,
            flush=True,
        )

    def end(self) -> None:
        """Leave the line as it is and go on below it."""
        if self._terminal and self._shown:
            print(file=sys.stderr)
