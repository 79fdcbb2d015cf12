"""`sendworthy`: the command line.

Each subcommand is a function `command(subparsers)` that adds its own parser and sets `run=`, a function from
the parsed arguments to the exit code. One whose flags cannot all be listed sets `further=`, too: it takes what the
parser does not know, and returns what of it is unknown indeed. Ours are in `proxy.commands`; others come through the
entry-point group `sendworthy.commands`. Only the command that was asked for is imported.
"""

import argparse
import errno
import io
import os
import re
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import NoReturn, TypeAlias

from proxy import exit_codes
from proxy.errors import CommandError
from proxy.no_openssl import leave_out
from proxy.version import version

Subparsers: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"  # noqa: SLF001 - it has no other name
Command = Callable[[Subparsers], None]

GROUP = "sendworthy.commands"
WITHOUT_COMMAND = ("-h", "--help", "--version")
"""Flags that stand in place of a command; all others follow one."""
BUILT_IN = (
    *(
        "run",
        "config",
        "doctor",
        "learn",
        "check",
        "schema",
        "explain",
        "why",
        "status",
        "top",
        "page",
        "mode",
        "profile",
        "push",
        "acl",
        "record",
    ),
    "completion",
)

EXAMPLES = """\
examples:
  sendworthy learn -o specs.d/learned.toml         a first spec, from the traffic of 30 s
  sendworthy check specs.d/*.toml                  are these utility specs right?
  sendworthy run --config sendworthy.toml          run the daemon of this robot
  sendworthy run --robot r1 --mode shadow          the same without a file
  sendworthy config                                what is configured, and where
  sendworthy doctor                                is this robot fit, and what to do about it?
  sendworthy status                                what the daemon here does
  sendworthy top                                   the same live, for all robots
  sendworthy page                                  and in a browser, with pictures and buttons
  sendworthy mode enforce                          switch it live
  sendworthy profile --flame flame.svg             where its processor time goes
  sendworthy record                                write down all that it sees and decides
  sendworthy push specs.d                          put these specs in force on all robots
  sendworthy acl --robots r1,r2                    access control for robots with certificates
  sendworthy explain robot/r1/camera image.jpg     why is this sample worth what it is?
  sendworthy why robot/r1/camera                   why were its last samples sent or dropped?
  eval "$(sendworthy completion bash)"             complete all that in this shell

`sendworthy COMMAND --help` tells more.
"""


UNWRITABLE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}
"""What the system says where output finds no room."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code. Ctrl-C, a closed pipe and a full disk are no tracebacks."""
    _prepare_output()
    try:
        try:
            return _command(argv)
        finally:
            sys.stdout.flush()  # also where the parser exits: Python would do it too late for us
    except KeyboardInterrupt:
        return exit_codes.INTERRUPTED
    except BrokenPipeError:
        _say_no_more()
        return exit_codes.OK
    except OSError as error:
        if error.errno not in UNWRITABLE:
            raise
        _say_no_more()
        where = f" {error.filename}" if error.filename else ""
        print(f"sendworthy: cannot write{where}: {error.strerror}", file=sys.stderr)
        return exit_codes.FAILED


def _prepare_output() -> None:
    """Have all that is printed go somewhere, in what can be shown there: names and keys may be of any script."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # who started us closed it, and a socket would take its place
            os.open(os.devnull, os.O_RDWR)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="replace")


def _say_no_more() -> None:
    """Lead standard output to nowhere: Python flushes it once more at its exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _command(argv: Sequence[str] | None) -> int:
    arguments = list(sys.argv[1:] if argv is None else argv)
    wanted = next((word for word in arguments if not word.startswith("-")), None)
    if wanted == "run":
        leave_out()  # before anything is imported that hashes
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # until it has files read anew: the first of it would end us
    try:
        whole, subparsers = parser(wanted)
    except CommandError as error:
        print(f"sendworthy: {error}", file=sys.stderr)
        return exit_codes.FAILED
    first = arguments[0] if arguments else ""
    if first.startswith("-") and first not in WITHOUT_COMMAND:
        if any(word in subparsers.choices for word in arguments):
            whole.error(f"unknown argument {first}: flags follow the command")
        refuse(first, whole)
    if first and first == wanted and wanted not in subparsers.choices:
        from utility_specs.suggestions import hint, quoted  # noqa: PLC0415 - pydantic comes with it

        whole.error(f"unknown command {quoted(wanted)}{hint(wanted, subparsers.choices)}")
    parsed, unknown = whole.parse_known_args(arguments)
    if unknown and hasattr(parsed, "further"):
        unknown = parsed.further(parsed, unknown)
    if unknown:
        refuse(unknown[0], subparsers.choices[str(wanted)])
    code: int = parsed.run(parsed)
    return code


def parser(wanted: str | None = None) -> tuple[argparse.ArgumentParser, Subparsers]:
    """Return the parser and its commands: the wanted one, or all when there is no such.

    Raises CommandError if the wanted one cannot be loaded; others that cannot are left out.
    """
    made = argparse.ArgumentParser(
        prog="sendworthy",
        description="Decides, sample by sample, what is worth sending over a robot team's radio channel.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    made.add_argument(
        "--version",
        action="version",
        version=f"sendworthy {version()}",
        help="show the version and exit",
    )
    subparsers = made.add_subparsers(title="commands", metavar="COMMAND", required=True)
    known = commands(wanted)
    for name, load in ({wanted: known[wanted]} if wanted in known else known).items():
        try:
            load()(subparsers)
        except Exception as error:
            if name == wanted:
                raise CommandError(f'the command "{name}" cannot be loaded: {error}') from error
    return made, subparsers


def refuse(word: str, of: argparse.ArgumentParser) -> NoReturn:
    """Exit 2 because of a word that `of` does not know, and suggest the flag that was meant."""
    import difflib  # noqa: PLC0415 - a daemon needs none

    flags = re.findall(r"(?<![\w-])--[\w.-]+", of.format_help().partition("\nexamples:")[0])
    if of.get_default("further") is not None:  # keys of the configuration, which not every help lists
        from proxy.config_loading import SETTINGS  # noqa: PLC0415 - a daemon needs none

        flags += [f"--{setting.key}" for setting in SETTINGS.values()]
    near = difflib.get_close_matches(word.partition("=")[0], flags, n=1) if word.startswith("-") else []
    if word.endswith(".toml") and "--config" in flags:
        near = [f"--config {word}"]
    meant = f" (did you mean {near[0]}?)" if near else ""
    of.error(f"unknown argument {word}{meant}")


def commands(wanted: str | None = None) -> dict[str, Callable[[], Command]]:
    """Return every command by name, each as a function that imports it; ours alone when one of them is wanted."""
    ours = {name: built_in(name) for name in BUILT_IN}
    if wanted in ours:
        return ours
    from importlib import metadata  # noqa: PLC0415 - large, and a daemon needs none

    return {entry.name: entry.load for entry in metadata.entry_points(group=GROUP)} | ours


def built_in(name: str) -> Callable[[], Command]:
    """Return a function that imports our command `name`."""

    def load() -> Command:
        command: Command = import_module(f"proxy.commands.{name}").command
        return command

    return load


if __name__ == "__main__":
    sys.exit(main())
