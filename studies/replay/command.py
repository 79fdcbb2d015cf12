"""`sendworthy replay`: what was decided once more, or what would have been decided under other specs and limits."""

import argparse
import sys
from pathlib import Path

from proxy import exit_codes
from studies.extras import missing
from utility_specs.errors import QuantityError, SpecsError
from utility_specs.units import DURATION, RATE

DESCRIPTION = """\
Drives the daemon's core over recorded traffic, and says what that is worth.

Without other specs, limits, robots or a policy a recording of a daemon is replayed as it was: the same events, and so
the same decisions to the last; any difference is said. With any of these, and for what `sendworthy import` made of a
ROS 2 bag or a CSV file, the traffic is flown anew in simulation: each robot has the core of a daemon, and one operator
wants everything. It prints by type what was sent and what it was worth, beside the offline bound: what somebody could
have gained at most who knew all samples beforehand. The bound takes some seconds for every 100 s of traffic.
"""
EXAMPLES = """\
examples:
  sendworthy replay r1.mcap                                  are these the decisions that were made?
  sendworthy replay r1.mcap --limit '1 Mbit/s'               what if the channel carried less?
  sendworthy replay r1.mcap --specs new.toml --html new.html what if these specs were in force? A page with plots
  sendworthy import bag/ -o bag.mcap
  sendworthy replay bag.mcap --specs ros2.toml --html bag.html
  sendworthy replay bag.mcap --specs ros2.toml --policy fits for comparison: send whatever fits
"""
MOST_ITERATIONS = 1_000_000
POLICIES = ("planner", "fits", "fixed-rate", "rank", "all")
"""By name; `studies.replay.policies` has what they are."""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "replay",
        help="replay a recording, as it was or with other specs and limits",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("files", metavar="FILE", nargs="+", type=Path, help="recordings: all parts of one, or those of several robots")
    add("--specs", metavar="PATH", action="append", type=Path, help="utility specs instead of the recorded ones")
    add("--limit", metavar="RATE", type=_rate, help="throughput instead of that of the specs, such as '2 Mbit/s'")
    add("--robots", metavar="NAME", nargs="+", help="only the traffic of these robots")
    add(
        "--policy",
        choices=POLICIES,
        help="who decides: the daemon's planner (default), whatever fits, each stream at a fixed rate, what is worth"
        " most by the byte of the next samples (which it knows), or all is sent whatever the limits are",
    )
    add("--iterations", metavar="N", type=_count, help="of each search (default: 300)")
    add("--latency", metavar="TIME", type=_duration, help="to the operator (default: 10 ms)")
    add("--seed", metavar="N", type=int, help="of the searches (default: 0)")
    add("--json", metavar="FILE", type=Path, help="write the figures here; - is standard output")
    add("--html", metavar="FILE", type=Path, help="write a page with plots here, which needs no other file")
    add("--no-bound", action="store_true", help="do not compute the offline bound")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Replay and report; return the exit code."""
    needed = ["mcap", *([] if arguments.no_bound else ["scipy"]), *(["matplotlib"] if arguments.html else [])]
    lacking = missing(*needed)
    if lacking is not None:
        without = "; --no-bound does without" if lacking.startswith("scipy is") else ""
        print(f"sendworthy replay: {lacking}{without}", file=sys.stderr)
        return exit_codes.FAILED
    from studies.replay.errors import ReplayError  # noqa: PLC0415 - all of this needs extras
    from studies.replay.replaying import replay  # noqa: PLC0415

    try:
        return replay(arguments)
    except (ReplayError, OSError) as error:
        print(f"sendworthy replay: {error}", file=sys.stderr)
        return exit_codes.FAILED
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG


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


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= MOST_ITERATIONS:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1 to {MOST_ITERATIONS:,}")
    return int(text)
