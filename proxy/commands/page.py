"""`sendworthy page`: the operator's page, in a browser."""

import argparse
import signal
import sys
from contextlib import ExitStack
from pathlib import Path

from proxy import exit_codes
from proxy.commands.client import DAEMON, add_token_flag, endpoint_flag, given_token, robot_flag
from proxy.commands.top import interval
from proxy.config_values import http_address, key_expression
from proxy.errors import ConfigError, ProxyError
from proxy.extras import needs, there
from utility_specs import SpecsError

DESCRIPTION = """\
Serves a page that shows the fleet live: what all cameras send, with rate and age, framed where something is worth more
than usual now; what became of the samples of each robot and type, and why; utility, the channel and what room costs.
With the token in the address that it prints, the page also switches the filter and puts specs in force, on robots whose
configuration allows it (`fleet.mode`, `fleet.specs`).

It looks through the operator's own daemon, like any application: what it wants to see, robots send. That is the first
one given with --connect; with --config the page runs one itself, and so joins the mesh where no daemon runs on this
machine. It needs nothing else from robots but their digests. Why samples were dropped only the robot itself
knows: where more daemons are given, theirs is shown, too.
"""
EXAMPLES = """\
examples:
  sendworthy page                                  and open the address that it prints
  sendworthy page --config ground.toml             no daemon runs here yet
  sendworthy page --key 'robot/*/camera'           see these keys, not all that specs cover
  sendworthy page --connect tcp/127.0.0.1:7447 --connect tcp/192.168.1.8:7447
  sendworthy page --listen 0.0.0.0:7448 --name ground.local     for other machines, too
"""
LISTEN = "127.0.0.1:7448"


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "page",
        help="show the fleet on a page in a browser, and steer it",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    _add_sources(parser)
    parser.add_argument(
        "--listen",
        metavar="HOST:PORT",
        type=_listen,
        default=LISTEN,
        help="serve the page here; who reaches it can watch (default: %(default)s)",
    )
    parser.add_argument(
        "--name",
        metavar="HOST",
        action="append",
        default=[],
        help="a name of this machine by which browsers may ask; addresses and localhost always may",
    )
    parser.add_argument(
        "--interval",
        metavar="SECONDS",
        type=interval,
        default=0.5,
        help="how often daemons are asked (default: %(default)g)",
    )
    add_token_flag(parser)
    parser.set_defaults(run=run)


def _add_sources(parser: argparse.ArgumentParser) -> None:
    """Let an operator say through whom to look, and at what."""
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help="run a daemon with this configuration, too, and look through it"
    )
    parser.add_argument(
        "--connect",
        metavar="ENDPOINT",
        type=endpoint_flag,
        action="append",
        help=f"where a daemon listens for applications, our own one first (default: {DAEMON})",
    )
    parser.add_argument(
        "--robot",
        metavar="NAME",
        type=robot_flag,
        help="whose daemon is ours, should several answer at the first place",
    )
    parser.add_argument(
        "--key",
        metavar="KEYEXPR",
        type=_key,
        action="append",
        default=[],
        help="see these keys; may be given several times (default: all that the specs in force cover)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Serve until a signal; return the exit code."""
    if not (there("starlette") and there("uvicorn")):
        print(f"sendworthy page {needs('page')}", file=sys.stderr)
        return exit_codes.FAILED
    try:
        with ExitStack() as opened:
            _serve(arguments, opened)
    except ConfigError as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    except (ProxyError, SpecsError) as error:
        print(f"sendworthy page: {error}", file=sys.stderr)
        return exit_codes.FAILED
    return exit_codes.OK


def _serve(arguments: argparse.Namespace, opened: ExitStack) -> None:
    """Serve until a signal; `opened` closes what is opened for it. Raises ProxyError and SpecsError."""
    from proxy.page.guard import new_token  # noqa: PLC0415 - what the page needs is an extra
    from proxy.page.page import Page  # noqa: PLC0415
    from proxy.page.server import Server, listening  # noqa: PLC0415

    place = opened.enter_context(listening(arguments.listen))
    endpoints = list(arguments.connect or [])
    if arguments.config is not None:
        from proxy.page.own_daemon import own_daemon  # noqa: PLC0415

        endpoints.insert(0, opened.enter_context(own_daemon(arguments.config)))
    signal.signal(signal.SIGTERM, _ended)
    token, places = new_token(), list(dict.fromkeys(endpoints or [DAEMON]))
    page = Page(places, arguments.robot, arguments.key, arguments.interval, given_token(arguments))
    host = arguments.name[0] if arguments.name else _host(arguments.listen)
    print(f"the page is at http://{host}:{place.getsockname()[1]}/#token={token}", flush=True)
    print("whoever has that address can steer the fleet; without what follows # it only shows", flush=True)
    Server(page, token, arguments.name).run(sockets=[place])


def _ended(_number: int, _frame: object) -> None:
    """End as after Ctrl-C, once the server has ended: all that was opened is closed."""
    raise SystemExit(exit_codes.OK)


def _host(listen: str) -> str:
    """Return the address to open: that of this machine where all are listened on."""
    host = listen.rpartition(":")[0]
    return {"0.0.0.0": "127.0.0.1", "[::]": "[::1]"}.get(host, host)  # noqa: S104 - told apart, not listened on


def _listen(text: str) -> str:
    """Read where to listen. Raises argparse.ArgumentTypeError."""
    try:
        if address := http_address(text):
            return address
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    raise argparse.ArgumentTypeError("must not be empty")


def _key(text: str) -> str:
    """Read a key expression. Raises argparse.ArgumentTypeError."""
    try:
        return key_expression(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
