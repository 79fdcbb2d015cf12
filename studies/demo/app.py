"""What the demo's apps share: they are plain Zenoh clients of whatever listens on localhost."""

import argparse
import struct
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TextIO

import zenoh

_STAMP = struct.Struct("<Qd")


def robot_parser(description: str | None) -> argparse.ArgumentParser:
    """Return a parser of the flags that all apps of a robot have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--robot", type=int, required=True, help="number of the robot, from 0")
    parser.add_argument("--robots", type=int, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--connect", required=True, help="endpoint of the router or daemon on localhost")
    parser.add_argument("--log", type=Path, help="file for one line of JSON per published sample")
    return parser


def open_client(endpoint: str) -> zenoh.Session:
    """Open a client session to the router at `endpoint`."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{endpoint}"]')
    config.insert_json5("connect/timeout_ms", "10000")
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def stamp(number: int, t_gen: float) -> bytes:
    """Return the attachment with which a camera numbers a frame and says when it was taken [s]."""
    return _STAMP.pack(number, t_gen)


def read_stamp(attachment: bytes) -> tuple[int, float]:
    """Return the number and the time [s] of a frame."""
    number, t_gen = _STAMP.unpack(attachment)
    return number, t_gen


def write_log(path: Path | None) -> AbstractContextManager[TextIO | None]:
    """Open a log, or none."""
    return nullcontext() if path is None else path.open("w")
