"""What a robot says of itself: an app that publishes its position and its battery's charge, and knows of no filter."""

import argparse
import json
import time
from threading import Event
from typing import TextIO

import zenoh

from studies.demo import cue
from studies.demo.app import open_client, robot_parser, write_log
from studies.demo.world import World

POSITIONS = 5
"""A robot says so many times a second where it is."""
LASTS = 5400.0
"""A full battery is empty after this time [s]."""


def main() -> None:
    """Publish from the start time on until told to stop."""
    arguments = robot_parser(__doc__).parse_args()
    stop = cue.stop_on_signal()
    with open_client(arguments.connect) as session, write_log(arguments.log) as log:
        _report(session, arguments, log, stop)


def _report(session: zenoh.Session, arguments: argparse.Namespace, log: TextIO | None, stop: Event) -> None:
    robot, world = arguments.robot, World(arguments.seed, arguments.robots)
    name, number = f"r{robot + 1}", 0
    cue.ready()
    start = cue.start_time() + (robot + 0.5) / arguments.robots / POSITIONS
    while number / POSITIONS < arguments.seconds - 1.0 / POSITIONS:
        if stop.wait(max(0.0, start + number / POSITIONS - time.monotonic())):
            return
        elapsed = number / POSITIONS
        x, y, heading = world.pose(robot, elapsed)
        said = {"position": {"x": round(x, 3), "y": round(y, 3), "heading": round(heading, 4)}}
        if number % POSITIONS == 0:
            said["battery"] = {"charge": round(max(0.0, 1.0 - elapsed / LASTS), 4)}
        for what, value in said.items():
            payload = json.dumps(value)
            t = time.monotonic()
            session.put(f"robot/{name}/{what}", payload, encoding=zenoh.Encoding.APPLICATION_JSON)
            if log:
                entry = {"event": "tell", "robot": name, "what": what, "t": t, "size": len(payload)}
                log.write(json.dumps(entry) + "\n")
                log.flush()
        number += 1
    stop.wait()


if __name__ == "__main__":
    main()
