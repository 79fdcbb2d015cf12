"""`sendworthy study`: what a mission is like, so that users see beforehand what they can gain."""

import argparse
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.extras import needs
from proxy.printable import clean
from studies.given import reason_of
from utility_specs.errors import QuantityError, SpecsError
from utility_specs.units import DURATION

DESCRIPTION = """\
Studies of missions. `characteristic` says how unequal the messages of a mission are, and with that how much can be
gained by choosing among them.
"""
CHARACTERISTIC = """\
Sends the samples of a mission at random, 30 times with another probability each, and says what those that were
received gained per second in which they were of use, as a part of the greatest: a histogram, the parts of messages of
low, medium and high utility, and what the better half of them is worth. Where most have a high utility it matters
little which are sent; where few have, who drops at random loses most.

It takes recordings of daemons, what `sendworthy import` made of a ROS 2 bag or a CSV file, or a mission of the
benchmark (see `sendworthy bench`).
"""
EXAMPLES = """\
examples:
  sendworthy study characteristic recordings/*.mcap
  sendworthy study characteristic bag.mcap --specs ros2.toml --picture characteristic.png
  sendworthy study characteristic r1.mcap --json -
  sendworthy study characteristic studies/bench/missions/paper-few.jsonl

exit codes:
  0  it is printed
  1  a recording cannot be read, or holds nothing that is worth anything
  78 the specs are wrong
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "study",
        help="say what a mission is like, and what can be gained in it",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    of = parser.add_subparsers(metavar="WHAT", required=True)
    one = of.add_parser(
        "characteristic",
        help="how unequal the messages of a mission are",
        description=CHARACTERISTIC,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = one.add_argument
    add(
        "files",
        metavar="FILE",
        nargs="+",
        type=Path,
        help="recordings: all parts of one, or those of several robots; or a mission",
    )
    add("--specs", metavar="PATH", action="append", type=Path, help="utility specs instead of the recorded ones")
    add("--latency", metavar="TIME", type=_duration, help="from a robot to whoever wants its samples (default: 10 ms)")
    add("--seed", metavar="N", type=_number, default=0, help="of what is dropped (default: 0)")
    add("--json", metavar="FILE", type=Path, help="write the figures here; - is standard output")
    add("--picture", metavar="FILE", type=Path, help="draw histogram and eCDF to this .png, .svg or .pdf file")
    one.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Characterise a mission; return the exit code."""
    try:
        from proxy.recording.errors import RecordingError  # noqa: PLC0415 - needs an extra
        from studies.replay.errors import ReplayError  # noqa: PLC0415
        from studies.study.errors import StudyError  # noqa: PLC0415
        from studies.study.recorded import characteristic  # noqa: PLC0415
    except ImportError:
        print(f"sendworthy study {needs('record')}", file=sys.stderr)
        return exit_codes.FAILED
    try:
        characteristic(arguments)
    except (StudyError, ReplayError, RecordingError) as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(reason_of(error))
    except SpecsError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    return exit_codes.OK


def _failed(reason: str) -> int:
    print(clean(f"sendworthy study: {reason}"), file=sys.stderr)
    return exit_codes.FAILED


def _duration(text: str) -> float:
    try:
        return DURATION.parse(text)
    except QuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _number(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text} is not a number from 0 on")
    return int(text)
