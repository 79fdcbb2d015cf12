"""Who watches daemons: asks them what `sendworthy top` asks, and scrapes their metrics as Prometheus does.

`python -m studies.benchmarks.watchers [--top ENDPOINT ...] [--scrape ADDRESS ... --every SECONDS]`, until told to stop.
A process of its own, so that what this takes is not counted as the daemon's.
"""

import argparse
import threading
import time
import urllib.request
from collections.abc import Sequence

from proxy.top.asking import Asking
from studies.demo import cue

INTERVAL = 1.0
"""Of `sendworthy top`, unless somebody says otherwise [s]."""
PATIENCE = 5.0
"""How long a scrape may take [s]."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Watch until told to stop, or a daemon cannot be scraped."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--top", nargs="*", default=[], help="endpoints of daemons to ask")
    parser.add_argument("--scrape", nargs="*", default=[], help="where metrics are served, HOST:PORT")
    parser.add_argument("--every", type=float, default=5.0, help="time between two scrapes [s]")
    options = parser.parse_args(arguments)
    stop = cue.stop_on_signal()
    asking = Asking(options.top, INTERVAL, lambda: None)
    asking.start()
    try:
        scrape(options.scrape, options.every, stop)
    finally:
        asking.stop()


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
