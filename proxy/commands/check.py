"""`sendworthy check`: tells whether utility specs are right."""

import argparse
import sys
from pathlib import Path

from utility_specs.check import check

DESCRIPTION = """\
Checks files of utility specs, or folders of them, as one set and without a daemon. Every mistake is named
with its file, line and key. The exit code is 0 when there is none, else 1.
"""
EXAMPLES = """\
examples:
  sendworthy check specs.d
  sendworthy check camera.toml lidar.toml
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check the files; return the exit code."""
    return check(arguments.paths, sys.stdout)
