"""Who watches daemons: asks what `sendworthy top` and `why KEY --follow` ask, scrapes as Prometheus does, records.

`python -m studies.benchmarks.watchers --robot ENDPOINT=KEY=ADDRESS ...`, until told to stop. KEY is what `why` asks
about, metrics are served at ADDRESS. Each line on its input is a list of those who watch from then on. A process of its
own, so that what this takes is not counted as the daemon's.
"""

import argparse
import sys
import threading
import time
import traceback
import urllib.request
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import NamedTuple

from proxy.commands.client import Client, NoAnswerError, connected
from proxy.commands.top import INTERVAL
from proxy.commands.why import MOST_PAUSE, pause
from proxy.top.asking import Asking
from proxy.why import LAST, Question
from studies.demo import cue

TOP, WHY, SCRAPER, RECORD = "top", "why", "scraper", "record"
SCRAPED_EVERY = 5.0
"""Time between two scrapes [s]."""
PATIENCE = 5.0
"""How long a scrape may take [s]."""


class Watched(NamedTuple):
    """A daemon: where it is asked, a key on which it decides, and where it serves metrics."""

    endpoint: str
    key: str
    address: str


class Watchers:
    """Nobody at first."""

    def __init__(self, daemons: Sequence[Watched]) -> None:
        self._daemons = daemons
        self._stack = ExitStack()
        self._recorded = [self._stack.enter_context(connected(each.endpoint)) for each in daemons]
        self._watching = ExitStack()

    def switch(self, names: Sequence[str]) -> None:
        """Have those of these names watch, and no others."""
        self._watching.close()
        if TOP in names:
            self._watching.enter_context(asking([each.endpoint for each in self._daemons]))
        if WHY in names:
            for each in self._daemons:
                self._watching.enter_context(beside(partial(follow, each.endpoint, each.key)))
        if SCRAPER in names:
            addresses = [each.address for each in self._daemons]
            self._watching.enter_context(beside(partial(scrape, addresses, SCRAPED_EVERY)))
        if RECORD in names:
            for daemon in self._recorded:
                self._watching.enter_context(recording(daemon))

    def close(self) -> None:
        """Nobody watches any more."""
        self._watching.close()
        self._stack.close()


def main(arguments: Sequence[str] | None = None) -> None:
    """Watch as told until told to stop; raises SystemExit when anybody could not go on."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", action="append", default=[], help="a daemon: ENDPOINT=KEY=ADDRESS")
    options = parser.parse_args(arguments)
    stop, failed = cue.stop_on_signal(), threading.Event()

    def fail(what: threading.ExceptHookArgs) -> None:
        traceback.print_exception(what.exc_value)
        failed.set()
        stop.set()

    threading.excepthook = fail
    watchers = Watchers([Watched(*each.rsplit("=", 2)) for each in options.robot])
    cue.listen(watchers.switch)
    cue.ready()
    stop.wait()
    watchers.close()
    sys.exit(failed.is_set())


@contextmanager
def asking(endpoints: Sequence[str]) -> Iterator[None]:
    """Ask these daemons as often as `top` does."""
    top = Asking(endpoints, INTERVAL, lambda: None)
    top.start()
    try:
        yield
    finally:
        top.stop()


@contextmanager
def recording(daemon: Client) -> Iterator[None]:
    """Have a daemon record."""
    robot = daemon.only_robot()
    daemon.record(robot, {"record": "start"})
    try:
        yield
    finally:
        with suppress(NoAnswerError):  # it may have gone
            daemon.record(robot, {"record": "stop"})


@contextmanager
def beside(work: Callable[[threading.Event], None]) -> Iterator[None]:
    """Do it on another thread, until it is told to stop."""
    stop = threading.Event()
    thread = threading.Thread(target=work, args=(stop,))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def follow(endpoint: str, key: str, stop: threading.Event) -> None:
    """Ask a daemon what it decides on a stream, again and again until told to `stop`. Raises NoAnswerError."""
    with connected(endpoint) as daemon:
        robot, after, wait = daemon.only_robot(), 0, MOST_PAUSE
        while not stop.wait(wait):
            answer = daemon.why(robot, Question(key, LAST[1], after))
            after, wait = answer["decided"], pause(answer, wait)


def scrape(addresses: Sequence[str], every: float, stop: threading.Event) -> None:
    """Read what is served at each address, again and again until told to `stop`. Raises OSError."""
    due = time.monotonic()
    while not stop.wait(max(0.0, due - time.monotonic())):
        for address in addresses:
            with urllib.request.urlopen(f"http://{address}/metrics", timeout=PATIENCE) as answer:
                answer.read()
        due += every


if __name__ == "__main__":
    main()
