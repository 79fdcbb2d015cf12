"""`sendworthy profile`: shows where the daemon's processor time goes."""

import argparse
import json
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.commands.client import NoAnswerError, add_client_flags, connected
from proxy.output import check_writable
from proxy.profiling.flame import flame
from proxy.profiling.request import RATE, SECONDS, ProfileError, Request
from proxy.profiling.table import table

DESCRIPTION = """\
Has a running daemon sample its own threads for a while, and shows what each stage of its work took of the processor:
for a sample, of a core, and of all that the daemon took. The stages:

  ingress     receives what applications publish
  features    extracts features from payloads
  core        decides what is due, and keeps the view of all robots
  window      gathers the messages of one decision
  tabulation  computes what each of them is worth
  search      finds which ones to send
  egress      publishes on the mesh
  digests     tells the other robots, and hears them
  bridge      all else that crosses: deliveries, queries, declarations, links
  zenoh       Zenoh's own threads
  other       configuration, log, control, and whatever else

Each thread counts with what the kernel says that it took; who waits counts nothing. ± is by how much a part may well be
off: a longer profile is more exact. Looking costs some 0.3 % of a core, which is told, and nothing when nobody asks.
One profile is taken at a time; `sendworthy status --json` shows the stages of the last one (daemon.profile).
Ctrl-C ends it, and what was seen until then is shown.
"""
EXAMPLES = """\
examples:
  sendworthy profile
  sendworthy profile --seconds 30 --flame flame.svg
  sendworthy profile --json | jq .stages
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "profile",
        help="show where the daemon's processor time goes",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    usual = Request()
    parser.add_argument(
        "--seconds",
        metavar="N",
        type=float,
        default=usual.seconds,
        help=f"how long, at most {SECONDS[1]:g} ({usual.seconds:g})",
    )
    parser.add_argument(
        "--rate",
        metavar="HZ",
        type=float,
        default=usual.rate,
        help=f"looks in a second that a thread runs, at most {RATE[1]:g} and one a tick ({usual.rate:g})",
    )
    parser.add_argument("--flame", metavar="FILE", type=Path, help="write a flame graph to this SVG file")
    parser.add_argument("--json", action="store_true", help="everything, with all stacks, as JSON")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Ask, wait and print; return the exit code."""
    try:
        request = Request(arguments.seconds, arguments.rate)
        check_writable([arguments.flame])
    except ProfileError as error:
        return _failed(error, exit_codes.USAGE)
    except OSError as error:
        return _failed(f"cannot write {error.filename}: {error.strerror}", exit_codes.FAILED)
    try:
        with connected(arguments.connect) as daemon, daemon.understood():
            profile = daemon.profile(arguments.robot or daemon.only_robot(), request)
            print(json.dumps(profile.write(), indent=2) if arguments.json else table(profile))
            drawn = flame(profile).encode() if arguments.flame else b""
    except NoAnswerError as error:
        return _failed(error, exit_codes.FAILED)
    if arguments.flame:
        try:
            arguments.flame.write_bytes(drawn)
        except OSError as error:
            return _failed(f"cannot write {arguments.flame}: {error.strerror}", exit_codes.FAILED)
    return exit_codes.OK


def _failed(error: object, code: int) -> int:
    print(f"sendworthy profile: {error}", file=sys.stderr)
    return code
