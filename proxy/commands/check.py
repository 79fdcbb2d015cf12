"""`sendworthy check`: tells whether utility specs are right, and the configuration."""

import argparse
import os
import sys
from pathlib import Path

from proxy import exit_codes
from proxy.config_loading import load_config
from proxy.errors import ConfigError
from utility_specs.check import check

DESCRIPTION = """\
Checks files of utility specs, or folders of them, as one set and without a daemon; with --config a configuration and
the specs that it names. Every mistake is named with its file, line and key. The exit code is 0
when there is none, else 1.
"""
EXAMPLES = """\
examples:
  sendworthy check specs.d
  sendworthy check camera.toml lidar.toml
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check the files; return the exit code."""
    if arguments.config is None and not arguments.paths:
        print("sendworthy check: give it a FILE or --config", file=sys.stderr)
        return exit_codes.USAGE
    try:
        paths = [*arguments.paths, *_specs_of(arguments.config)]
    except ConfigError as error:
        print(error)
        return exit_codes.FAILED
    return check(paths, sys.stdout) if paths else exit_codes.OK


def _specs_of(config: Path | None) -> list[Path]:
    """Return where the specs of a configuration are, if it has any. Raises ConfigError."""
    if config is None:
        return []
    path = load_config(config, os.environ, {}).specs.path
    print(f"{config}: right{'' if path.exists() else ', without specs'}")
    return [path] if path.exists() else []
