"""`sendworthy push`: put utility specs in force on all robots."""

import argparse
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.commands.client import add_client_flags, add_token_flag, ordered
from proxy.errors import PushError
from proxy.pushed import gathered, pack
from utility_specs import SpecsError
from utility_specs.loader import load_set

DESCRIPTION = """\
Checks files of utility specs, or folders of them, and puts them in force on all robots of the team, through the daemon
here. Each robot takes them whole, in place of those that it has, or refuses them and keeps its own; it says which.
Robots take specs only if `fleet.specs` is true in their configurations, and those with a `fleet.token` only from who
knows it.
"""
EXAMPLES = """\
examples:
  sendworthy push specs.d
  sendworthy push specs.d --connect tcp/192.168.1.7:7447
  sendworthy push specs.d --token-file fleet.token
  sendworthy push specs.d --unchecked        they need Python modules that only the robots have

The exit code is 0 when all robots took them, else 1.
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "push",
        help="put utility specs in force on all robots",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("paths", metavar="FILE", nargs="+", type=Path, help="a file or a folder of *.toml")
    parser.add_argument("--unchecked", action="store_true", help="leave it to the robots to check them")
    add_token_flag(parser)
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check and push; return the exit code."""
    try:
        if not arguments.unchecked:
            load_set(arguments.paths)
        packed = pack(gathered(arguments.paths))
    except (SpecsError, PushError) as error:
        print(error, file=sys.stderr)
        return exit_codes.FAILED
    return ordered("push", arguments, "specs", packed)
