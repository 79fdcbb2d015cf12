"""Who watches daemons: asks what `sendworthy top` and `why KEY --follow` ask, and scrapes metrics as Prometheus does.

`python -m studies.benchmarks.watchers [--top ENDPOINT ...] [--why ENDPOINT=KEY ...] [--scrape ADDRESS ... --every
SECONDS]`, until told to stop. A process of its own, so that what this takes is not counted as the daemon's.
"""

import argparse
import threading
import time
import urllib.request
from collections.abc import Sequence
from contextlib import suppress

from proxy.commands.client import NoAnswerError, connected
from proxy.commands.top import INTERVAL
from proxy.commands.why import MOST_PAUSE, pause
from proxy.top.asking import Asking
from proxy.why import LAST, Question
from studies.demo import cue

PATIENCE = 5.0
"""How long a scrape may take [s]."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Watch until told to stop, or a daemon cannot be scraped."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--top", nargs="*", default=[], help="endpoints of daemons to ask")
    parser.add_argument("--why", nargs="*", default=[], help="endpoints of daemons to ask why, each with =KEY")
    parser.add_argument("--scrape", nargs="*", default=[], help="where metrics are served, HOST:PORT")
    parser.add_argument("--every", type=float, default=5.0, help="time between two scrapes [s]")
    options = parser.parse_args(arguments)
    stop = cue.stop_on_signal()
    asking = Asking(options.top, INTERVAL, lambda: None)
    asking.start()
    following = [threading.Thread(target=follow, args=(*each.rsplit("=", 1), stop)) for each in options.why]
    for thread in following:
        thread.start()
    try:
        scrape(options.scrape, options.every, stop)
    finally:
        stop.set()
        asking.stop()
        for thread in following:
            thread.join()


def follow(endpoint: str, key: str, stop: threading.Event) -> None:
    """Ask a daemon what it decides on a stream, again and again until told to `stop` or it goes away."""
    with suppress(NoAnswerError), connected(endpoint) as daemon:
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
