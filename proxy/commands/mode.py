"""`sendworthy mode`: switch a running daemon between pass, shadow and enforce."""

import argparse
import sys

from proxy import exit_codes
from proxy.commands.client import NoAnswerError, add_client_flags, add_token_flag, connected, ordered
from proxy.core.model.mode import Mode
from utility_specs.suggestions import hint, quoted

DESCRIPTION = """\
Switches a running daemon, at once and without a restart.

  pass      a plain bridge: no decisions
  shadow    decides, counts and explains, but forwards everything
  enforce   decides and acts on it

The mode lasts until the daemon ends; `mode` in the configuration is what it starts with. With --fleet all robots of the
team are switched whose configuration allows it (`fleet.mode`), those with a `fleet.token` only by who knows it; each
says whether it did.
"""
EXAMPLES = """\
examples:
  sendworthy mode shadow
  sendworthy mode enforce --connect tcp/192.168.1.7:7447
  sendworthy mode shadow --fleet
  sendworthy mode shadow --fleet --token-file fleet.token
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "mode",
        help="switch the daemon to pass, shadow or enforce",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("mode", metavar="MODE", type=_mode, choices=tuple(Mode), help="pass, shadow or enforce")
    parser.add_argument("--fleet", action="store_true", help="switch all robots of the team")
    add_token_flag(parser)
    add_client_flags(parser)
    parser.set_defaults(run=run)


def _mode(text: str) -> str:
    """Read a mode for argparse."""
    if text not in list(Mode):
        raise argparse.ArgumentTypeError(f"unknown {quoted(text)}{hint(text, Mode)}")
    return text


def run(arguments: argparse.Namespace) -> int:
    """Switch and say so; return the exit code."""
    if arguments.fleet:
        return ordered("mode", arguments, "mode", arguments.mode.encode())
    try:
        with connected(arguments.connect) as daemon:
            robot = arguments.robot or daemon.only_robot()
            daemon.switch(robot, arguments.mode)
    except NoAnswerError as error:
        print(f"sendworthy mode: {error}", file=sys.stderr)
        return exit_codes.FAILED
    print(f"{robot}: {arguments.mode}")
    return exit_codes.OK
