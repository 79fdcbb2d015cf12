"""A camera of a robot: an app that publishes what it sees and knows nothing of any filter."""

import argparse
import json
import time
from pathlib import Path
from threading import Event
from typing import TextIO

import cv2
import zenoh

from studies.demo import cue
from studies.demo.app import open_client, stamp
from studies.demo.scene import PERIOD, Scene, phases, schedule


def main() -> None:
    """Publish frames from the start time on until told to stop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", type=int, required=True, help="number of the robot, from 0")
    parser.add_argument("--robots", type=int, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--connect", required=True, help="endpoint of the router or daemon on localhost")
    parser.add_argument("--log", type=Path, required=True, help="file for one line of JSON per published frame")
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    cv2.setNumThreads(1)  # every robot has cores of its own; here they share
    with open_client(arguments.connect) as session, arguments.log.open("w") as log:
        _film(session, arguments, log, stop)


def _film(session: zenoh.Session, arguments: argparse.Namespace, log: TextIO, stop: Event) -> None:
    name = f"r{arguments.robot + 1}"
    phase = phases(arguments.seed, arguments.robots)[arguments.robot]
    episodes = schedule(arguments.seed, arguments.robots, arguments.seconds)
    scene = Scene(arguments.seed, arguments.robot, phase, episodes)
    publisher = session.declare_publisher(
        f"robot/{name}/camera",
        encoding=zenoh.Encoding.IMAGE_JPEG,
        congestion_control=zenoh.CongestionControl.DROP,
    )
    number, frame = 0, scene.frame(0)
    cue.ready()
    start = cue.start_time()
    while phase + number * PERIOD < arguments.seconds:
        if stop.wait(max(0.0, start + phase + number * PERIOD - time.monotonic())):
            return
        t_gen = time.monotonic()
        publisher.put(frame.jpeg, attachment=stamp(number, t_gen))
        entry = {"event": "publish", "robot": name, "number": number, "t": t_gen}
        log.write(json.dumps(entry | {"size": len(frame.jpeg), "red": frame.red}) + "\n")
        log.flush()
        # Rendered ahead, so that a frame leaves the moment it is due.
        number, frame = number + 1, scene.frame(number + 1)
    stop.wait()


if __name__ == "__main__":
    main()
