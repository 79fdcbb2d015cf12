"""The applications of a flight: plain Zenoh clients, one a robot that publishes, and the operator's that listens.

`python -m studies.benchmarks.traffic.application publish|listen --connect ENDPOINT --log FILE [--agenda FILE]`

An agenda is JSON: `robot` (its number), `keys` (of its streams), `reliable` (streams that may not be dropped on the
way to the daemon), and `samples`: when after the start [s], stream, number and size [B]. A log has a line of JSON for
each sample: [stream, number, size, due, published] or [robot, stream, number, size, t_gen, t]. It is written at once,
since a session whose daemon ends at the same time may hold whoever publishes, undeclares or closes.
"""

import argparse
import json
import threading
import time
from pathlib import Path
from typing import TextIO

import zenoh

from studies.benchmarks.traffic.payload import Label, payload, read
from studies.demo import cue
from studies.demo.app import open_client

ALL = "*/*"
"""What the operator wants."""
PATIENCE = 20.0
"""How long the operator may take to be heard of [s]."""


def main() -> None:
    """Open a session, say so, and do what is asked for from the start time until told to stop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", choices=("publish", "listen"))
    parser.add_argument("--connect", required=True, help="endpoint of the daemon")
    parser.add_argument("--log", type=Path, required=True, help="file for what happened")
    parser.add_argument("--agenda", type=Path, help="file of what to publish")
    options = parser.parse_args()
    stop = cue.stop_on_signal()
    with options.log.open("w", buffering=1) as log, open_client(options.connect) as session:
        if options.role == "listen":
            _listen(session, log, stop)
        else:
            _publish(session, options.agenda, log, stop)


def _listen(session: zenoh.Session, log: TextIO, stop: threading.Event) -> None:
    def take(sample: zenoh.Sample) -> None:
        now = time.monotonic()
        label = read(bytes(sample.payload))
        _note(log, *label.name, label.size, label.t_gen, now)

    with session.declare_subscriber(ALL, zenoh.handlers.Callback(take, indirect=False)):
        cue.ready()
        stop.wait()


def _publish(session: zenoh.Session, agenda: Path, log: TextIO, stop: threading.Event) -> None:
    plan = json.loads(agenda.read_text())
    publishers = [_publisher(session, key, block=at in plan["reliable"]) for at, key in enumerate(plan["keys"])]
    _wait_until_wanted(publishers, stop)
    cue.ready()
    start = cue.start_time()
    for due, stream, number, size in plan["samples"]:
        if stop.wait(max(0.0, start + due - time.monotonic())):
            break
        now = time.monotonic()
        publishers[stream].put(payload(Label(plan["robot"], stream, number, size, now)))
        _note(log, stream, number, size, start + due, now)
    stop.wait()


def _note(log: TextIO, *values: float) -> None:
    log.write(json.dumps(values) + "\n")


def _publisher(session: zenoh.Session, key: str, *, block: bool) -> zenoh.Publisher:
    control = zenoh.CongestionControl.BLOCK if block else zenoh.CongestionControl.DROP
    return session.declare_publisher(key, congestion_control=control)


def _wanted(publisher: zenoh.Publisher) -> bool:
    status: object = publisher.matching_status  # an omission of Zenoh's stubs
    return bool(getattr(status, "matching", False))


def _wait_until_wanted(publishers: list[zenoh.Publisher], stop: threading.Event) -> None:
    """Wait until the operator's wish has come through both daemons: a robot flies when it is watched."""
    deadline = time.monotonic() + PATIENCE
    while not all(map(_wanted, publishers)):
        if stop.wait(0.02) or time.monotonic() > deadline:
            raise TimeoutError("nobody wants what is published")


if __name__ == "__main__":
    main()
