"""The operator's screen: an app that shows the last frame of every robot and notes when each arrived."""

import argparse
import json
import time
from pathlib import Path
from threading import Event, Lock
from typing import TextIO

import zenoh

from studies.demo import cue
from studies.demo.app import open_client, read_stamp


class Screen:
    """The last frame of each robot. Called from Zenoh's thread, read from the main one."""

    def __init__(self, log: TextIO) -> None:
        self._log = log
        self._frames: dict[str, bytes] = {}
        self._lock = Lock()

    def show(self, sample: zenoh.Sample) -> None:
        """Put a frame on the screen and note its arrival."""
        received = time.monotonic()
        robot = str(sample.key_expr).split("/")[1]
        number, t_gen = read_stamp(bytes(sample.attachment or b""))
        jpeg = bytes(sample.payload)
        entry = {"event": "receive", "robot": robot, "number": number, "t": received, "t_gen": t_gen}
        with self._lock:
            self._frames[robot] = jpeg
            self._log.write(json.dumps(entry | {"size": len(jpeg)}) + "\n")
            self._log.flush()

    def photograph(self, folder: Path) -> None:
        """Write what is on the screen to `folder`, one file per robot."""
        with self._lock:
            frames = dict(self._frames)
        for robot, jpeg in frames.items():
            (folder / f"{robot}.jpg").write_bytes(jpeg)


def main() -> None:
    """Watch all cameras until told to stop; photograph the screen once."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--connect", required=True, help="endpoint of the router or daemon on localhost")
    parser.add_argument("--log", type=Path, required=True, help="file for one line of JSON per received frame")
    parser.add_argument("--photograph-at", type=float, required=True, help="seconds after the start")
    parser.add_argument("--photographs", type=Path, required=True, help="folder for the frames on the screen then")
    arguments = parser.parse_args()
    stop = cue.stop_on_signal()
    with arguments.log.open("w") as log, open_client(arguments.connect) as session:
        screen = Screen(log)
        callback = zenoh.handlers.Callback(screen.show, indirect=False)
        with (
            session.declare_subscriber("robot/*/camera", callback),
            session.declare_subscriber("robot/*/position", lambda _: None),
            session.declare_subscriber("robot/*/battery", lambda _: None),
        ):
            _watch(screen, arguments.photograph_at, arguments.photographs, stop)


def _watch(screen: Screen, photograph_at: float, photographs: Path, stop: Event) -> None:
    cue.ready()
    start = cue.start_time()
    if not stop.wait(max(0.0, start + photograph_at - time.monotonic())):
        screen.photograph(photographs)
        stop.wait()


if __name__ == "__main__":
    main()
