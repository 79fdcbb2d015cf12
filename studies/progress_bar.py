"""How far flights are: by a bar in a terminal where the package rich is there, else by a line now and then."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from proxy.extras import there
from studies.replay.progress import Progress

Advance = Callable[[float], None]
"""One more is done, which is so much of the whole."""


@contextmanager
def flights(count: int, total: float) -> Iterator[Advance]:
    """Show how many of so many flights are done, which are `total` altogether, in whatever unit; on standard error."""
    if there("rich") and sys.stderr.isatty():
        with _bar(count, total) as advance:
            yield advance
        return
    done = 0.0
    progress = Progress(lambda share: f"{100 * share:.0f} % of {count} flights are flown")

    def plainly(part: float) -> None:
        nonlocal done
        done += part
        progress(done / total)

    yield plainly
    progress.end()


@contextmanager
def _bar(count: int, total: float) -> Iterator[Advance]:
    from rich.console import Console  # noqa: PLC0415 - belongs to the extra "top"
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn  # noqa: PLC0415
    from rich.progress import Progress as Bar  # noqa: PLC0415

    columns: list[Any] = [TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn()]
    flown = 0
    with Bar(*columns, console=Console(stderr=True), speed_estimate_period=600) as bar:
        whole = bar.add_task(f"0 of {count} flights", total=total)

        def advance(part: float) -> None:
            nonlocal flown
            flown += 1
            bar.update(whole, advance=part, description=f"{flown} of {count} flights")

        yield advance
