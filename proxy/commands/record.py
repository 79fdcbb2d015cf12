"""`sendworthy record`: has the daemon write down all that it sees and decides."""

import argparse
import math
import sys
from typing import Any

from proxy import clock, exit_codes
from proxy.commands.client import Client, NoAnswerError, add_client_flags, connected
from proxy.requests import Requests, asked_to_end

DESCRIPTION = """\
Has a running daemon record every event that its core sees, with the features of samples, and every decision, into MCAP
files in its folder `record.folder`, until Ctrl-C or for --seconds. `sendworthy replay` drives the core through them
once more; Foxglove shows them. With `record.on` in the configuration a daemon records from its start on.
"""
EXAMPLES = """\
examples:
  sendworthy record --seconds 60
  sendworthy record --payloads
  sendworthy record --on        go on without this command, until:
  sendworthy record --off
"""
WIDTH = 76
"""A shorter line covers a longer one before it."""
LOOK = 1.0
"""Time between two looks at what was recorded [s]."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "record",
        help="write down all that the daemon sees and decides",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--payloads", action="store_true", help="record the payloads of samples, too")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--seconds", metavar="S", type=_seconds, help="how long (until Ctrl-C)")
    how.add_argument("--on", action="store_true", help="begin, and leave the daemon recording")
    how.add_argument("--off", action="store_true", help="end what was begun so, or by the configuration")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Begin, wait and end; return the exit code."""
    try:
        with connected(arguments.connect) as daemon, daemon.understood():
            robot = arguments.robot or daemon.only_robot()
            return _run(daemon, robot, arguments)
    except NoAnswerError as error:
        print(f"sendworthy record: {error}", file=sys.stderr)
        return exit_codes.FAILED


def _run(daemon: Client, robot: str, arguments: argparse.Namespace) -> int:
    if arguments.off:
        return _ended(daemon.record(robot, {"record": "stop"}))
    with asked_to_end() as asked:  # from here on it is ended in order
        told = daemon.record(robot, {"record": "start", "payloads": arguments.payloads})
        if not told["file"]:
            daemon.record(robot, {"record": "stop"})
            print(f"sendworthy record: the daemon cannot record: {told['problem']}", file=sys.stderr)
            return exit_codes.FAILED
        begun = f"robot {robot} records to {told['file']}"
        if arguments.on:
            print(begun)
            return exit_codes.OK
        try:
            print(begun, flush=True)
            _wait(daemon, robot, arguments.seconds, asked)
        finally:  # where nobody reads what is printed, too, as of a pipe that is closed
            told = daemon.record(robot, {"record": "stop"})
        return _ended(told)


def _wait(daemon: Client, robot: str, seconds: float | None, asked: Requests) -> None:
    """Wait until it is `asked` to end, or for so long [s], and show how it goes meanwhile."""
    end = math.inf if seconds is None else clock.monotonic() + seconds
    while (left := end - clock.monotonic()) > 0.0 and not asked.next(min(LOOK, left)):
        if sys.stdout.isatty():
            print(f"\r  {_so_far(daemon.record(robot, {})):<{WIDTH}}", end="", flush=True)
    if sys.stdout.isatty():
        print()


def _ended(told: dict[str, Any]) -> int:
    files = f" and {told['files'] - 1} before it" if told["files"] > 1 else ""
    print(f"recorded to {told['file']}{files}: {_so_far(told)}")
    return exit_codes.FAILED if told["problem"] else exit_codes.OK


def _so_far(told: dict[str, Any]) -> str:
    missing = f", {told['missing']:,} missing" if told["missing"] else ""
    problem = f" ({told['problem']})" if told["problem"] else ""
    return f"{told['events']:,} event{'s' * (told['events'] != 1)}, {told['bytes'] / 1e6:,.2f} MB{missing}{problem}"


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 0.0 < seconds < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a number above 0")
    return seconds
