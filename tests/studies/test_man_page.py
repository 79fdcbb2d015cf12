"""The manual page is made of a parser: all of it, whatever the terminal."""

import argparse

import pytest

from studies.man_page import escaped, page, text, usage


@pytest.fixture
def whole():
    """A command line with one command."""
    made = argparse.ArgumentParser(
        prog="fly", description="Flies.", epilog="examples:\n  fly up 'r*'\n\nThat is all.\n"
    )
    commands = made.add_subparsers(metavar="COMMAND")
    up = commands.add_parser("up", description="Goes up:\n\n  at once\n\nor later.")
    up.add_argument("--by", metavar="M", type=float, default=2.0, help="so far, 100 %% of it (default: %(default)g)")
    up.add_argument("-q", "--quiet", action="store_true", help="without a word")
    up.add_argument("--to", required=True, help="there")
    up.add_argument("--secret", help=argparse.SUPPRESS)
    either = up.add_mutually_exclusive_group()
    either.add_argument("--fast", action="store_true", help="fast")
    either.add_argument("--slow", metavar="S", help="slow")
    up.add_argument("robot", help="who")
    up.add_argument("others", metavar="ROBOT", nargs="*", help="who else")
    return made


def test_usage_tells_what_must_be_and_what_may_be(whole):
    """Flags first; of those that exclude each other one."""
    (commands,) = (action for action in whole._actions if action.choices)
    assert usage(commands.choices["up"]) == "[--by M] [-q] --to TO [--fast | --slow S] ROBOT [ROBOT ...]"
    assert usage(whole) == "COMMAND ..."


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ({"nargs": "?"}, "[FILE]"),
        ({"nargs": "+"}, "FILE [FILE ...]"),
        ({}, "FILE"),
    ],
)
def test_usage_tells_how_many(made, words):
    """As people write it."""
    command = argparse.ArgumentParser(prog="fly up")
    command.add_argument("file", **made)
    assert usage(command) == words


def test_a_usage_of_its_own_is_taken():
    """Where a command has too many flags to list."""
    assert usage(argparse.ArgumentParser(prog="fly up", usage="fly up [--KEY VALUE ...]")) == "[--KEY VALUE ...]"


def test_one_of_some_may_be_demanded():
    """Then they stand in other brackets."""
    command = argparse.ArgumentParser(prog="fly up")
    group = command.add_mutually_exclusive_group(required=True)
    group.add_argument("--fast", action="store_true")
    group.add_argument("--slow", action="store_true")
    assert usage(command) == "(--fast | --slow)"


def test_everything_is_on_the_page(whole):
    """Commands with all that is not secret, and what was said before and after."""
    assert page(whole).splitlines() == [
        '.TH FLY 1 "" Fly "User Commands"',
        '.\\" Made of the parser by `make man`.',
        ".SH NAME",
        "fly \\- flies",
        ".SH SYNOPSIS",
        ".B fly",
        "COMMAND ...",
        ".SH OPTIONS",
        *(".TP", ".B \\-h, \\-\\-help", "tell how it is used; behind a command, how that one is"),
        ".SH COMMANDS",
        ".SS up",
        ".PP",
        ".B fly up",
        "[\\-\\-by M] [\\-q] \\-\\-to TO [\\-\\-fast | \\-\\-slow S] ROBOT [ROBOT ...]",
        *(".PP", "Goes up:"),
        *(".RS 4", ".nf", "at once", ".fi", ".RE"),
        *(".PP", "or later."),
        *(".TP", ".B ROBOT", "who"),
        *(".TP", ".B ROBOT", "who else"),
        *(".TP", ".B \\-\\-by M", "so far, 100 % of it (default: 2)"),
        *(".TP", ".B \\-q, \\-\\-quiet", "without a word"),
        *(".TP", ".B \\-\\-to TO", "there"),
        *(".TP", ".B \\-\\-fast", "fast"),
        *(".TP", ".B \\-\\-slow S", "slow"),
        ".SH EXAMPLES",
        *(".RS 4", ".nf", "fly up \\(aqr*\\(aq", ".fi", ".RE"),
        *(".PP", "That is all."),
    ]


def test_the_page_does_not_follow_the_terminal(whole, monkeypatch):
    """It is the same wherever it is made."""
    wide = page(whole)
    monkeypatch.setenv("COLUMNS", "30")
    assert page(whole) == wide


def test_titles_inside_a_command_are_no_sections():
    """They go with the command."""
    assert list(text("exit codes:\n  0  fine\n", ".PP\n.I")) == [
        *(".PP\n.I exit codes:", ".RS 4", ".nf", "0  fine", ".fi", ".RE"),
    ]


@pytest.mark.parametrize(
    ("plain", "marked"),
    [
        ("--x", "\\-\\-x"),
        (".x", "\\&.x"),
        ("'x'", "\\(aqx\\(aq"),
        ('a\\b `c` "d" ~ ^', "a\\eb \\(gac\\(ga \\(dqd\\(dq \\(ti \\(ha"),
        ("5 μs", "5 \\[u03BC]s"),
    ],
)
def test_text_is_nothing_but_text(plain, marked):
    """Whatever it holds: what is copied from the page can be run."""
    assert escaped(plain) == marked
