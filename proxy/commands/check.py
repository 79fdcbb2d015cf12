"""`sendworthy check`: tells whether utility specs are right, and the configuration."""

import argparse
import os
import sys
from pathlib import Path
from typing import TextIO

from proxy import exit_codes
from proxy.config_loading import load_config
from proxy.errors import ConfigError
from utility_specs.check import Report, check, told
from utility_specs.errors import SpecProblem
from utility_specs.loader import holds_specs

DESCRIPTION = """\
Checks files of utility specs, or folders of them, as one set and without a daemon; with --config a configuration and
the specs that it names. Every mistake is named with its file, line and key; so is, as a warning, what can be flown but
hardly is meant: keys that an earlier type takes, features that nothing uses, samples that fill more than a window,
limits that never bind, or hold little beside what the daemons of four robots tell each other. Guarantees that limits
cannot bear are mistakes, as far as forecast.size, forecast.streams and forecast.schedule tell.

The exit code is 0 when there is no mistake, whatever the warnings, 1 with any, and 2 for a wrong command line.
"""
EXAMPLES = """\
examples:
  sendworthy check specs.d
  sendworthy check camera.toml lidar.toml
  sendworthy check --json specs.d
  sendworthy check --config /etc/sendworthy/sendworthy.toml
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
    parser.add_argument("paths", metavar="FILE", nargs="*", type=Path, help="a file or a folder of *.toml")
    parser.add_argument("--config", metavar="FILE", type=Path, help="a configuration; its specs are checked, too")
    parser.add_argument("--json", action="store_true", help="print what is found as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check the files; return the exit code."""
    if arguments.config is None and not arguments.paths:
        print("sendworthy check: give it a FILE or --config", file=sys.stderr)
        return exit_codes.USAGE
    try:
        paths = [*arguments.paths, *_specs_of(arguments.config, sys.stderr if arguments.json else sys.stdout)]
    except ConfigError as error:
        if not arguments.json:
            print(error)
            return exit_codes.FAILED
        wrong = tuple(SpecProblem(arguments.config, None, "", problem) for problem in error.problems)
        return told(Report((), wrong), sys.stdout, as_json=True)
    return check(paths, sys.stdout, as_json=arguments.json)


def _specs_of(config: Path | None, out: TextIO) -> list[Path]:
    """Return where the specs of a configuration are, if it has any. Raises ConfigError."""
    if config is None:
        return []
    read = load_config(config, os.environ, {})
    path = read.specs.path
    found = holds_specs(path)
    for outdated in read.outdated:
        print(f"{outdated} (a warning)", file=out)
    print(f"{config}: right{'' if found else f', no specs in {path}: everything passes'}", file=out)
    return [path] if found else []
