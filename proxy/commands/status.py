"""`sendworthy status`: shows what the daemon does."""

import argparse
import json
import sys

from proxy import exit_codes
from proxy.commands.client import NoAnswerError, add_client_flags, connected
from proxy.status_table import table

DESCRIPTION = (
    "Asks a running daemon for everything it knows: streams, counts by reason, decisions, peers, budget, mode."
)
EXAMPLES = """\
examples:
  sendworthy status
  sendworthy status --json | jq .counts
  sendworthy status --connect tcp/192.168.1.7:7447
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "status",
        help="show what the daemon does",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--json", action="store_true", help="everything, as JSON (a list if several daemons answer)")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Ask and print; return the exit code."""
    try:
        with connected(arguments.connect) as daemon:
            statuses = daemon.status(arguments.robot)
    except NoAnswerError as error:
        print(f"sendworthy status: {error}", file=sys.stderr)
        return exit_codes.FAILED
    if arguments.json:
        print(json.dumps(statuses[0] if len(statuses) == 1 else statuses, indent=2))
    else:
        print("\n\n".join(table(status) for status in statuses))
    return exit_codes.OK
