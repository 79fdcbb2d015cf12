"""`sendworthy import`: a ROS 2 bag or a CSV file as a recording that `sendworthy replay` flies."""

import argparse
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.extras import needs, there
from proxy.printable import clean
from studies.foreign.errors import ImportFailedError
from studies.given import once, reason_of
from utility_specs.errors import SpecsError

DESCRIPTION = """\
Makes a recording of traffic that others recorded, for `sendworthy replay` to fly.

ROS 2 bags (rosbag2, as MCAP or sqlite3): the folder, or a file of it. Each bag is one robot, named after its file
unless --robot names it; with --by-namespace the first word of a topic is the robot. Keys are those of rmw_zenoh, as in
utility_specs/ros2.toml, or the topics themselves with --topics-as-keys. Payloads are kept, so that any specs can be
tried; with --specs only the features that these know. What was cut off is read as far as it goes.

CSV (.csv, .tsv, .txt): the columns t_gen [s], robot, key, size [B]. Other columns of numbers become features of the
same name, and columns of text are ignored.
"""
EXAMPLES = """\
examples:
  sendworthy import rosbag2_2026_01_01/ -o bag.mcap
  sendworthy replay bag.mcap --specs ros2.toml --limit '2 Mbit/s' --html bag.html
  sendworthy import r1_bag/ r2_bag/ --specs ros2.toml -o team.mcap    two robots; features without payloads
  sendworthy import traffic.csv -o traffic.mcap
"""
TABLES = (".csv", ".tsv", ".txt")
PARTS = (".mcap", ".db3")
"""Files of bags."""
MOST_DOMAIN = 232


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "import",
        help="make a recording of a ROS 2 bag or a CSV file",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("files", metavar="FILE", nargs="+", type=Path, help="bags or CSV files, all of one recording")
    add("-o", "--output", metavar="OUT.mcap", type=Path, required=True, help="the recording to write")
    add("--force", action="store_true", help="replace it if it exists")
    add("--specs", metavar="PATH", action="append", type=Path, help="keep the features of these specs, not payloads")
    add("--robot", metavar="NAME", help="whose bag it is (default: the bag's name)")
    add("--by-namespace", action="store_true", help="the first word of a topic is the robot")
    add("--topics-as-keys", action="store_true", help="keys are topics, as with zenoh-plugin-ros2dds")
    add("--domain", metavar="ID", type=int, choices=range(MOST_DOMAIN + 1), default=0, help="of ROS (default: 0)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Import; return the exit code."""
    try:
        from studies.foreign.importing import make  # noqa: PLC0415 - needs an extra
    except ImportError:
        print(f"sendworthy import {needs('record')}", file=sys.stderr)
        return exit_codes.FAILED
    arguments.files = once(arguments.files, PARTS)
    bags = [path for path in arguments.files if path.suffix.lower() not in TABLES]
    if bags and not there("rosbags"):
        print(f"sendworthy import: {bags[0]} {needs('ros2')}", file=sys.stderr)
        return exit_codes.FAILED
    try:
        make(arguments, bags)
    except ImportFailedError as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(reason_of(error))
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    return exit_codes.OK


def _failed(reason: str) -> int:
    print(clean(f"sendworthy import: {reason}"), file=sys.stderr)
    return exit_codes.FAILED
