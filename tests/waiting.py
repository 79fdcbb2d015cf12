"""Waiting for a condition instead of for time."""

import time
from collections.abc import Callable

USUAL = 0.1
"""What `_work` takes on an idle core of a small computer [s]."""
MOST = 10.0
"""How many times longer than asked for a wait may take: what never comes must fail some time."""


def wait_until(
    condition: Callable[[], object], timeout: float = 60.0, what: str | Callable[[], str] = "the condition"
) -> None:
    """Return as soon as `condition` holds; fail with `what` when it does not in `timeout` seconds of a usual machine.

    Where the machine turns out to be slow when these are over, it is given as many times longer. `what` may be asked
    then: it tells how things are.
    """
    started = time.monotonic()
    allowed = timeout
    while not condition():
        waited = time.monotonic() - started
        if waited > allowed:
            allowed = max(allowed, timeout * slowness())
            if waited > allowed:
                told = what() if callable(what) else what
                raise AssertionError(f"{told} did not come true within {waited:.0f} s")
        time.sleep(0.005)


def slowness() -> float:
    """Return how many times longer than usual this machine takes now, busy as it is: from 1 to `MOST`."""
    started = time.monotonic()
    _work()
    return min(max((time.monotonic() - started) / USUAL, 1.0), MOST)


def _work() -> None:
    sum(range(5_000_000))  # in C: measuring coverage must not look like a slow machine
