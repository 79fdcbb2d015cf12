"""`sendworthy top`: a robot or the fleet, live."""

import argparse
import sys

from proxy import exit_codes
from proxy.commands.client import DAEMON, endpoint_flag, robot_flag
from proxy.extras import needs
from proxy.top.view import KEYS, View

DESCRIPTION = """\
Shows what daemons do, live: how full the channel is, which streams are made, sent and dropped and why, how old they are
where they are wanted, what room costs, what the planner takes, and who else is there. A robot whose daemon is not asked
is shown as another one sees it. Where input or output is no terminal it does as with --once.
"""
EXAMPLES = """\
examples:
  sendworthy top
  sendworthy top --fleet                           one row per robot
  sendworthy top --robot r2 --interval 0.5
  sendworthy top --once                            one picture, for a file or a mail
  sendworthy top --connect tcp/192.168.1.7:7447 --connect tcp/192.168.1.8:7447

keys:
""" + "\n".join(f"  {key:10} {meaning}" for key, meaning in KEYS.items())
INTERVAL = 2.0
"""How often daemons are asked, unless somebody says otherwise [s]: of 200 streams each answer takes one 2 ms."""
LEAST_INTERVAL, MOST_INTERVAL = 0.1, 3600.0


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "top",
        help="show what a robot or the fleet does, live",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--robot", metavar="NAME", type=robot_flag, help="show this robot (key: n)")
    parser.add_argument("--fleet", action="store_true", help="show all robots, one row each (key: f)")
    parser.add_argument("--once", action="store_true", help="print one picture, of one interval, and leave")
    parser.add_argument(
        "--interval",
        metavar="SECONDS",
        type=interval,
        default=INTERVAL,
        help="how often daemons are asked (default: %(default)g)",
    )
    parser.add_argument(
        "--connect",
        metavar="ENDPOINT",
        type=endpoint_flag,
        action="append",
        help=f"where a daemon listens for applications; may be given several times (default: {DAEMON})",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show it; return the exit code."""
    try:
        from proxy.top import screen  # noqa: PLC0415 - rich is an extra
    except ModuleNotFoundError:
        print(f"sendworthy top {needs('top')}", file=sys.stderr)
        return exit_codes.FAILED
    view = View(robot=arguments.robot, fleet=arguments.fleet)
    endpoints = list(dict.fromkeys(arguments.connect or [DAEMON]))
    if arguments.once or not (sys.stdin.isatty() and sys.stdout.isatty()):
        return exit_codes.OK if screen.once(endpoints, view, arguments.interval) else exit_codes.FAILED
    screen.live(endpoints, view, arguments.interval)
    return exit_codes.OK


def interval(text: str) -> float:
    """Read the interval. Raises argparse.ArgumentTypeError."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not LEAST_INTERVAL <= seconds <= MOST_INTERVAL:
        raise argparse.ArgumentTypeError(f"must be {LEAST_INTERVAL:g} to {MOST_INTERVAL:g} seconds, not {text!r}")
    return seconds
