"""`sendworthy check`: tells whether utility specs are right."""

import argparse
import sys
from pathlib import Path

from utility_specs.check import check

DESCRIPTION = """\
Checks files of utility specs, or folders of them, as one set and without a daemon. Every mistake is named
with its file, line and key; so is, as a warning, what can be flown but hardly is meant: keys that an earlier
type takes, features that nothing uses, samples that fill more than a window, limits that never bind. Guarantees
that the limits cannot bear are mistakes, as far as forecast.size, forecast.streams and the schedules tell.

The exit code is 0 when there is no mistake, whatever the warnings, 1 with any, and 2 for a wrong command line.
"""
EXAMPLES = """\
examples:
  sendworthy check specs.d
  sendworthy check camera.toml lidar.toml
  sendworthy check --json specs.d
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "check",
        help="check utility specs",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("paths", metavar="FILE", nargs="+", type=Path, help="a file or a folder of *.toml")
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check the files; return the exit code."""
    return check(arguments.paths, sys.stdout, as_json=arguments.json)
