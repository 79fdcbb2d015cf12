"""The manual page of `sendworthy`, made of its parser; `make man` writes deploy/man/sendworthy.1 anew.

Nothing here asks argparse to format: its layout differs between versions of Python and follows the terminal.
"""

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

from proxy.cli import parser

MARKS = {
    "\\": "\\e",
    "-": "\\-",
    "'": "\\(aq",
    "`": "\\(ga",
    "^": "\\(ha",
    "~": "\\(ti",
    '"': "\\(dq",
}
"""What roff would take for a mark, or print as another character than can be copied into a shell."""
COMMANDS = argparse._SubParsersAction  # noqa: SLF001 - it has no other name
HELP = argparse._HelpAction  # noqa: SLF001 - nor has this
TITLE = re.compile("[a-z ]{,20}:")
FEW: dict[str | int | None, str] = {None: "{}", "?": "[{}]", "*": "[{} ...]", "+": "{} [{} ...]"}
"""How positional arguments are written, by how many there may be."""


def page(whole: argparse.ArgumentParser) -> str:
    """Return the manual page of a parser and its commands."""
    return "\n".join(_page(whole)) + "\n"


def _page(whole: argparse.ArgumentParser) -> Iterator[str]:
    yield f'.TH {escaped(whole.prog.upper())} 1 "" {escaped(whole.prog.capitalize())} "User Commands"'
    yield '.\\" Made of the parser by `make man`.'
    yield from (".SH NAME", f"{escaped(whole.prog)} \\- {escaped(_brief(whole.description))}")
    yield from (".SH SYNOPSIS", f".B {escaped(whole.prog)}", escaped(usage(whole)))
    yield from (".SH OPTIONS", ".TP", ".B \\-h, \\-\\-help", "tell how it is used; behind a command, how that one is")
    yield from _arguments(whole)
    yield ".SH COMMANDS"
    yield from _commands(whole)
    yield from text(whole.epilog, ".SH")


def _commands(whole: argparse.ArgumentParser, before: str = "") -> Iterator[str]:
    """Yield the sections of the commands of a parser, and of theirs."""
    for action in _told(whole):
        if isinstance(action, COMMANDS):
            for name, command in action.choices.items():
                yield from _command(f"{before}{name}", command)


def _command(name: str, command: argparse.ArgumentParser) -> Iterator[str]:
    yield f".SS {escaped(name)}"
    yield from (".PP", f".B {escaped(command.prog)}", escaped(usage(command)))
    yield from text(command.description, ".PP\n.I")
    yield from _arguments(command)
    yield from text(command.epilog, ".PP\n.I")
    yield from _commands(command, f"{name} ")


def _brief(description: str | None) -> str:
    sentence = (description or "").strip().rstrip(".")
    return sentence[:1].lower() + sentence[1:]


def usage(command: argparse.ArgumentParser) -> str:
    """Return the arguments of a command on one line; that there is --help goes without saying."""
    if command.usage:
        return command.usage.removeprefix(command.prog).strip()
    either = {
        id(action): group
        for group in command._mutually_exclusive_groups  # noqa: SLF001 - argparse tells nobody else
        for action in group._group_actions  # noqa: SLF001
    }
    actions = sorted(_told(command), key=lambda action: _is_positional(action) and id(action) not in either)
    words = []
    for group, members in groupby(actions, key=lambda action: either.get(id(action))):
        if group is None:
            words += [_in_usage(action) for action in members]
        else:
            choice = " | ".join(_invoked(action, action.option_strings[:1]) for action in members)
            words.append(f"({choice})" if group.required else f"[{choice}]")
    return " ".join(words)


def _told(command: argparse.ArgumentParser) -> list[argparse.Action]:
    """Return the arguments that there is something to say of."""
    actions = command._actions  # noqa: SLF001 - argparse tells nobody else
    return [action for action in actions if action.help != argparse.SUPPRESS and not isinstance(action, HELP)]


def _is_positional(action: argparse.Action) -> bool:
    return not action.option_strings


def _in_usage(action: argparse.Action) -> str:
    if isinstance(action, COMMANDS):
        return f"{action.metavar} ..."
    if _is_positional(action):
        return FEW.get(action.nargs, "{}").format(_name(action), _name(action))
    invoked = _invoked(action, action.option_strings[:1])
    return invoked if action.required else f"[{invoked}]"


def _invoked(action: argparse.Action, flags: Sequence[str]) -> str:
    """Return how an argument is written: each of the flags with its value, or its name."""
    if _is_positional(action):
        return _name(action)
    return ", ".join(flag if action.nargs == 0 else f"{flag} {_name(action)}" for flag in flags)


def _name(action: argparse.Action) -> str:
    return str(action.metavar or action.dest.upper())


def _arguments(command: argparse.ArgumentParser) -> Iterator[str]:
    """Yield what each argument is for."""
    for action in sorted(_told(command), key=_is_positional, reverse=True):
        if not isinstance(action, COMMANDS):
            yield from (".TP", f".B {escaped(_invoked(action, action.option_strings))}")
            yield escaped(str(action.help) % {**vars(action), "prog": command.prog})


def text(source: str | None, heading: str) -> Iterator[str]:
    """Yield text: what is indented stays as it is, and short lines like "exit codes:" are headings."""
    for kind, lines in groupby((source or "").splitlines(), key=_kind):
        if kind == "literal":
            yield from (".RS 4", ".nf", *(escaped(line.removeprefix("  ")) for line in lines), ".fi", ".RE")
        elif kind == "title":
            yield from (
                f"{heading} {escaped(line.upper().rstrip(':') if heading == '.SH' else line)}" for line in lines
            )
        elif kind == "prose":
            yield from (".PP", *map(escaped, lines))


def _kind(line: str) -> str:
    if not line.strip():
        return "blank"
    if line.startswith("  "):
        return "literal"
    return "title" if TITLE.fullmatch(line) else "prose"


def escaped(line: str) -> str:
    """Return a line in which roff finds nothing but text, which it prints as it is."""
    marked = "".join(MARKS.get(sign) or (sign if sign.isascii() else f"\\[u{ord(sign):04X}]") for sign in line)
    return f"\\&{marked}" if marked.startswith(".") else marked


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(parser()[0]))
