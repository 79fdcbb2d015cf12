"""`sendworthy replay`: what was decided once more, or what would have been decided under other specs and limits."""

import argparse
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.extras import needs
from proxy.printable import clean
from studies.given import reason_of
from studies.replay.errors import ReplayError
from utility_specs.errors import QuantityError, SpecsError
from utility_specs.units import DURATION, RATE

DESCRIPTION = """\
Drives the daemon's core through what a recording holds, and says whether it decides the same: each plan, found by as
many iterations as then, and each command is compared. Files of one robot that follow each other are one recording.

With other specs, limits, robots or another policy, and for what `sendworthy import` made of a ROS 2 bag or a CSV file,
the traffic is flown anew in simulation: each robot has the core of a daemon, and one operator wants everything.
Adaptive limits are fixed at what the channel bore in the mean when it was recorded. By type it prints what was sent and
what it was worth, beside the offline bound: what somebody could have gained at most who knew all samples beforehand.
The bound takes about ten seconds for every 100 s of traffic.
"""
EXAMPLES = """\
examples:
  sendworthy replay recordings/*.mcap                      are these the decisions that were made?
  sendworthy replay r1.mcap --limit '1 Mbit/s'             what if the channel carried less?
  sendworthy replay r1.mcap --specs new.toml --html r.html what if these specs were in force? A page with plots
  sendworthy replay bag.mcap --specs ros2.toml             what would it have done with this bag? See `import`
  sendworthy replay bag.mcap --specs ros2.toml --policy fits   and who sends whatever fits?

exit codes:
  0  all is as it was, or was flown anew
  1  something differs, or cannot be read or replayed
  78 the specs are wrong
"""
MOST_ITERATIONS = 1_000_000
POLICIES = ("planner", "fits", "fixed-rate", "rank", "all")
"""By name; `studies.replay.policies` has what they are."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "replay",
        help="drive the core through a recording once more",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("files", metavar="FILE", nargs="+", type=Path, help="recordings: all parts of one, or those of several robots")
    add("--specs", metavar="PATH", action="append", type=Path, help="utility specs instead of the recorded ones")
    add("--limit", metavar="RATE", type=_rate, help="throughput instead of that of the specs, such as '2 Mbit/s'")
    add("--robots", metavar="NAME,...", action="append", help="only the traffic of these robots")
    add(
        "--policy",
        choices=POLICIES,
        help="who decides: the daemon's planner (default), whatever fits, each stream at a fixed rate, what is worth"
        " most by the byte of the next samples (which it knows), or all is sent whatever the limits are",
    )
    add("--iterations", metavar="N", type=_count, help="of each search (default: 300)")
    add("--latency", metavar="TIME", type=_duration, help="to the operator (default: 10 ms)")
    add("--loss", metavar="PART", type=_part, help="what is lost on the way to the operator, such as 0.05 (default: 0)")
    add("--seed", metavar="N", type=int, help="of the searches (default: 0)")
    add("--json", metavar="FILE", type=Path, help="write the figures here; - is standard output")
    add("--html", metavar="FILE", type=Path, help="write a page with plots here, which needs no other file")
    add("--python", action="store_true", help="run the Python that the recorded specs name: for files that you trust")
    add("--no-bound", action="store_true", help="do not compute the offline bound")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Replay and report; return the exit code."""
    try:
        from studies.replay.replaying import replay  # noqa: PLC0415 - needs an extra
    except ImportError:
        print(f"sendworthy replay {needs('record')}", file=sys.stderr)
        return exit_codes.FAILED
    try:
        return replay(arguments)
    except ReplayError as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(reason_of(error))
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG


def _failed(reason: str) -> int:
    print(clean(f"sendworthy replay: {reason}"), file=sys.stderr)
    return exit_codes.FAILED


def _rate(text: str) -> float:
    try:
        return RATE.parse(text)
    except QuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _duration(text: str) -> float:
    try:
        return DURATION.parse(text)
    except QuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _part(text: str) -> float:
    try:
        part = float(text)
    except ValueError:
        part = -1.0
    if not 0.0 <= part < 1.0:
        raise argparse.ArgumentTypeError(f"{text} is no part from 0 to less than 1")
    return part


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= MOST_ITERATIONS:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to {MOST_ITERATIONS:,}")
    return int(text)
