"""`sendworthy doctor`: whether this robot is fit, and what to do about it."""

import argparse
import json
from dataclasses import asdict

from proxy.commands.client import endpoint_flag
from proxy.commands.config_flags import LAYERS, add_config_flags, reader

DESCRIPTION = f"""\
Looks at this robot, with its daemon or without: the configuration, the ports, the interface of the radio, multicast
on it, the power save of Wi-Fi, the clock, certificates, the specs, room for recordings; with the daemon also at its
warnings, applications around it, and the versions and limits of the other robots. Says in one line each what is, and
where it is not fine what to do. Nothing is changed, and the messages that try multicast do not leave this host.

{LAYERS}"""
EXAMPLES = """\
examples:
  sendworthy doctor
  sudo sendworthy doctor                           root sees which process has a port
  sendworthy doctor --config sendworthy.toml
  sendworthy doctor --json | jq '.[] | select(.state == "finding")'

It takes every flag of `sendworthy run`: give it those of the daemon.

exit codes:
  0   all is fine
  1   there is something to do
  2   nothing to do, as far as could be looked; something could not, such as other robots without a daemon
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "doctor",
        help="look at this robot, and say what to do",
        usage="sendworthy doctor [--config FILE] [--KEY VALUE ...] [--connect ENDPOINT] [--json]",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--connect",
        metavar="ENDPOINT",
        type=endpoint_flag,
        help="where the daemon listens for applications (default: as configured)",
    )
    parser.add_argument("--json", action="store_true", help="print an object for each line, as JSON")
    add_config_flags(parser, listed=False)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Look and print; return the exit code."""
    from proxy.doctor.doctor import examine  # noqa: PLC0415 - much of the daemon, which its --help does without
    from proxy.doctor.finding import exit_code  # noqa: PLC0415

    found = []
    for each in examine(reader(arguments), arguments.connect):
        found.append(each)
        if not arguments.json:
            print(each, flush=True)
    if arguments.json:
        print(json.dumps([asdict(each) for each in found], indent=2))
    return exit_code(found)
