"""`sendworthy status`: shows what the daemon does."""

import argparse
import json
import shutil
import sys

from proxy import exit_codes
from proxy.commands.client import NoAnswerError, add_client_flags, connected
from proxy.status.explaining import explained
from proxy.status.text import text

DESCRIPTION = (
    "Asks a running daemon for everything it knows: streams, counts by reason, decisions, peers, budget, mode."
)
PAGE_WIDTH = 80
"""How wide explanations are that go into a file."""
EXAMPLES = """\
examples:
  sendworthy status
  sendworthy status --explain                      what each word and column means
  sendworthy status --json | jq .counts            `sendworthy schema status` describes it
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
    parser.add_argument("--explain", action="store_true", help="say what each word and column means; asks no daemon")
    parser.add_argument("--json", action="store_true", help="everything, as JSON (a list if several daemons answer)")
    add_client_flags(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Ask and print; return the exit code."""
    if arguments.explain:
        print(explained(terminal_width() or PAGE_WIDTH))
        return exit_codes.OK
    try:
        with connected(arguments.connect) as daemon:
            statuses = daemon.status(arguments.robot)
    except NoAnswerError as error:
        print(f"sendworthy status: {error}", file=sys.stderr)
        return exit_codes.FAILED
    if arguments.json:
        print(json.dumps(statuses[0] if len(statuses) == 1 else statuses, indent=2))
    else:
        print("\n\n".join(text(status, terminal_width()) for status in statuses))
    return exit_codes.OK


def terminal_width() -> int | None:
    """Return how wide the terminal is that we print on; None where it is none."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None
