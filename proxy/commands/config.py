"""`sendworthy config`: the configuration as a daemon would have it, and where each value comes from."""

import argparse
import json
import sys

from proxy import exit_codes
from proxy.commands.config_flags import LAYERS, add_config_flags, reader
from proxy.config_origins import entries
from proxy.config_text import data, toml
from proxy.errors import ConfigError

DESCRIPTION = f"""\
Prints the configuration that `sendworthy run` would have with the same flags, here and now: TOML, and behind each value
its file and line, its variable, or its flag. Passwords, tokens and private keys are not shown.

{LAYERS}"""
EXAMPLES = """\
examples:
  sendworthy config
  sendworthy config --config sendworthy.toml --mesh.zenoh.transport.link.tx.lease 5000
  sendworthy config --json | jq '.[] | select(.origin.kind != "default")'

It takes every flag of `sendworthy run`. The exit code is 78 when the configuration is wrong; every mistake is named.
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "config",
        help="print the configuration, and where each value comes from",
        usage="sendworthy config [--config FILE] [--KEY VALUE ...] [--json]",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--json", action="store_true", help="print an object for each key, as JSON")
    add_config_flags(parser, listed=False)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print it; return the exit code."""
    try:
        layered = reader(arguments)()
    except ConfigError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    for outdated in layered.config.outdated:
        print(f"{outdated} (a warning)", file=sys.stderr)
    found = tuple(entries(layered))
    print(json.dumps(data(found), indent=2) if arguments.json else "\n".join(toml(found)))
    return exit_codes.OK
