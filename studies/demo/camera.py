"""A camera of a robot: an app that publishes what it sees and knows nothing of any filter."""

import argparse
import json
import sys
import time
from pathlib import Path
from random import Random
from threading import Event
from typing import TextIO

import cv2
import zenoh

from studies.demo import cue
from studies.demo.app import open_client, robot_parser, stamp, write_log
from studies.demo.footage import Footage, open_footage
from studies.demo.processes import DemoError
from studies.demo.scene import PERIOD, Film, Scene
from studies.demo.world import Episode, phases, schedule


def main() -> None:
    """Publish frames from the start time on until told to stop."""
    parser = robot_parser(__doc__)
    parser.add_argument("--footage", type=Path, help="a video or a folder of images, in place of the drawn world")
    parser.add_argument("--offset", type=float, default=0.0, help="which part of the footage to leave out at first")
    parser.add_argument("--told", action="store_true", help="red objects are there when they are told, not by the seed")
    parser.add_argument("--keep", type=float, default=1.0, help="send frames at random, with this probability")
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    cv2.setNumThreads(1)  # every robot has cores of its own; here they share
    with open_client(arguments.connect) as session, write_log(arguments.log) as log:
        try:
            _film(session, arguments, log, stop)
        except DemoError as error:
            sys.exit(str(error))


def _film(session: zenoh.Session, arguments: argparse.Namespace, log: TextIO | None, stop: Event) -> None:
    name = f"r{arguments.robot + 1}"
    phase = phases(arguments.seed, arguments.robots, PERIOD)[arguments.robot]
    film, draw = _open_film(arguments), Random(f"{arguments.seed} {arguments.robot}")
    publisher = session.declare_publisher(
        f"robot/{name}/camera",
        encoding=zenoh.Encoding.IMAGE_JPEG,
        congestion_control=zenoh.CongestionControl.DROP,
    )
    number, frame = 0, film.frame(0)
    cue.ready()
    start = cue.start_time()
    if isinstance(film, Scene):
        cue.listen(lambda told: film.add(Episode(**told)))
    while phase + number * PERIOD < arguments.seconds:
        if stop.wait(max(0.0, start + phase + number * PERIOD - time.monotonic())):
            return
        t_gen = time.monotonic()
        if draw.random() < arguments.keep:
            publisher.put(frame.jpeg, attachment=stamp(number, t_gen))
        if log:
            entry = {"event": "publish", "robot": name, "number": number, "t": t_gen}
            log.write(json.dumps(entry | {"size": len(frame.jpeg), "red": frame.red}) + "\n")
            log.flush()
        # Drawn ahead, so that a frame leaves the moment it is due.
        number, frame = number + 1, film.frame(number + 1)
    stop.wait()


def _open_film(arguments: argparse.Namespace) -> Film:
    if arguments.footage:
        return open_footage(Footage(arguments.footage, arguments.offset))
    episodes = () if arguments.told else schedule(arguments.seed, arguments.robots, arguments.seconds)
    return Scene(arguments.seed, arguments.robot, arguments.robots, episodes)


if __name__ == "__main__":
    main()
