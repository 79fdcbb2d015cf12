"""The manual page is that of the command line as it is."""

import shutil
import subprocess

import pytest

from proxy import cli
from studies.man_page import page
from tests.daemons import ROOT

PAGE = ROOT / "deploy" / "man" / "sendworthy.1"


def test_the_page_is_what_the_parser_gives():
    """Whoever changes a command runs `make man`."""
    assert PAGE.read_text() == page(cli.parser()[0]), "run `make man`"


def test_man_shows_it():
    """With every command, and without a complaint of roff."""
    if shutil.which("groff") is None:
        pytest.skip("needs groff")
    command = ["groff", "-man", "-ww", "-Tutf8", "-P-cbou", PAGE]
    shown = subprocess.run(command, capture_output=True, text=True, check=True)
    assert shown.stderr == ""
    for name in cli.commands():
        assert f"\n   {name}\n" in shown.stdout
    assert """sendworthy why 'robot/*/camera' --follow""" in shown.stdout
