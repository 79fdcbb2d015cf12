"""`sendworthy completion`: a script that teaches a shell the command line."""

import argparse
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from proxy import exit_codes
from proxy.config_loading import SETTINGS
from proxy.extras import needs

SHELLS = "bash", "zsh", "fish"
COMMANDS = argparse._SubParsersAction  # noqa: SLF001 - it has no other name
VALUES = {setting.key: setting.values for setting in SETTINGS.values()}
"""What flags for keys of the configuration can be, where these are few words."""
DESCRIPTION = """\
Prints a script that makes a shell complete commands, flags, their values and files, also those of commands that other
packages bring along. It is made of the parser of this version: renew it after an update.
"""
EXAMPLES = """\
examples:
  sendworthy completion bash > ~/.local/share/bash-completion/completions/sendworthy
  sendworthy completion zsh > ~/.zfunc/_sendworthy     where fpath has ~/.zfunc before compinit
  sendworthy completion fish > ~/.config/fish/completions/sendworthy.fish
  eval "$(sendworthy completion bash)"                 for this shell alone
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "completion",
        help="print a script with which a shell completes the command line",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help=", ".join(SHELLS))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print it; return the exit code."""
    try:
        import shtab  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        print(f"sendworthy completion {needs('completion')}", file=sys.stderr)
        return exit_codes.FAILED
    from proxy.cli import parser  # noqa: PLC0415 - which imports this module

    whole, _subparsers = parser()
    for action in actions(whole):
        action.choices = _choices(action)
        if action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        if isinstance(action, COMMANDS):
            for brief in action._choices_actions:  # noqa: SLF001 - argparse tells nobody else
                action.choices[brief.dest].description = brief.help
    print(shtab.complete(whole, arguments.shell))
    return exit_codes.OK


def _choices(action: argparse.Action) -> Iterable[Any] | None:
    """Return what an argument can be, as shtab takes it: any other table it holds for one of commands."""
    if action.choices is None:
        return VALUES.get(action.dest) or None
    return action.choices if isinstance(action, COMMANDS) else tuple(action.choices)


def actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield every argument of a parser and of its commands."""
    for action in parser._actions:  # noqa: SLF001 - argparse tells nobody else
        yield action
        if isinstance(action, COMMANDS):
            for inner in action.choices.values():
                yield from actions(inner)
