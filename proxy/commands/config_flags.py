"""The flags of commands that read a configuration: the file, and a flag for every key."""

import argparse
import os
from collections import deque
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from proxy.config_files import STANDARD, standard
from proxy.config_loading import SETTINGS, Layered, load_layered

LAYERS = f"""\
The configuration is {STANDARD}, or the file of --config; the files conf.d/*.toml beside it, by name; variables
SENDWORTHY_…; and flags. The later wins, key by key, also inside app.zenoh and mesh.zenoh. A flag is two dashes and the
key, a variable the key in capitals, with two underscores for each dot: SENDWORTHY_MESH__ZENOH__MODE is mesh.zenoh.mode.
"""


def add_config_flags(parser: argparse.ArgumentParser, *, listed: bool) -> None:
    """Add them; `listed`: the help tells every key."""
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help=f"the configuration (default: {STANDARD}, where it is)"
    )
    keys = parser.add_argument_group("keys of the configuration") if listed else parser
    for setting in SETTINGS.values():
        told = setting.description.replace("%", "%%") if listed else argparse.SUPPRESS
        keys.add_argument(f"--{setting.key}", metavar="VALUE", dest=setting.key, help=told)
    parser.set_defaults(further=further, inside={})


def further(arguments: argparse.Namespace, words: Sequence[str]) -> list[str]:
    """Take flags of keys inside open tables, `--app.zenoh.scouting.delay 0`; return all other words."""
    others, left = [], deque(words)
    tables = tuple(f"--{setting.key}." for setting in SETTINGS.values() if setting.takes_table)
    while left:
        flag, equals, value = left.popleft().partition("=")
        if flag.startswith(tables):
            follows = not equals and left and not left[0].startswith("--")
            arguments.inside[flag.removeprefix("--")] = left.popleft() if follows else value
        else:
            others.append(f"{flag}{equals}{value}")
    return others


def reader(arguments: argparse.Namespace) -> "partial[Layered]":
    """Return what reads the configuration that was asked for, now or later. It raises ConfigError."""
    flags = {setting.key: getattr(arguments, setting.key) for setting in SETTINGS.values()}
    given = {key: text for key, text in flags.items() if text is not None} | arguments.inside
    return partial(load_layered, standard(arguments.config), os.environ, given)
