"""`sendworthy acl`: the access control of a team, to be pasted into the configuration."""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from proxy import exit_codes
from proxy.access import access_control
from proxy.config_text import written
from proxy.config_values import robot_name

DESCRIPTION = """\
Prints access control for robots that have a certificate each, with the robot's name as its common name. With it a
robot takes what others say of themselves only from them: nobody can speak, or leave, in another one's name. Of all
others, certificate or not, nothing is taken. Orders for all robots (`push`, `mode --fleet`) are taken from the
operators, which are robots too; where none are named, from nobody.

All robots get the same file. They take it up with a restart. Where they meet at a router (`mesh.mode = "client"`) the
router gets it instead, with --router as a part of its own Zenoh configuration.
"""
EXAMPLES = """\
examples:
  sendworthy acl --robots r1,r2,ground --operators ground > /etc/sendworthy/conf.d/access.toml
  sendworthy acl --robots r1,r2                               nobody gives orders
  sendworthy acl --robots r1,r2 --router > access.json5       for zenohd
"""
_TABLE = "mesh.zenoh.access_control"


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "acl",
        help="print access control for robots with certificates",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--robots", metavar="NAME,...", type=_names, required=True, help="all robots of the team")
    parser.add_argument(
        "--operators", metavar="NAME,...", type=_names, default=(), help="those whose orders the robots obey"
    )
    parser.add_argument("--router", action="store_true", help="print it for the router that robots meet at, as JSON5")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print it; return the exit code."""
    try:
        control = access_control(arguments.robots, arguments.operators)
    except ValueError as error:
        print(f"sendworthy acl: {error}", file=sys.stderr)
        return exit_codes.FAILED
    orders = f" --operators {','.join(arguments.operators)}" if arguments.operators else ""
    printed_by = f"Printed by: sendworthy acl --robots {','.join(arguments.robots)}{orders}"
    if arguments.router:
        print(f"// {printed_by} --router")
        print(json.dumps({"access_control": control}, indent=2))
        return exit_codes.OK
    print(f"# {printed_by}")
    print("\n".join(_toml(control)))
    return exit_codes.OK


def _names(text: str) -> tuple[str, ...]:
    """Read names of robots for argparse."""
    try:
        return tuple(robot_name(name.strip()) for name in text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _toml(control: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a table, what is a list of tables with a line for each."""
    yield f"[{_TABLE}]"
    for key, value in control.items():
        if not isinstance(value, list):
            yield f"{key} = {written(value)}"
            continue
        yield f"{key} = ["
        yield from (f"    {written(each)}," for each in value)
        yield "]"
