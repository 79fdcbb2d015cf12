"""The manual: its links lead somewhere, its examples are right, its commands are run."""

import re
import tomllib

import pytest

from proxy.bridge.bounds import BOUNDS
from proxy.config_loading import load_config
from tests.docs.pages import PAGES, ROOT, blocks, commands
from tests.docs.test_guides import RUN as RUN_BESIDE_A_DAEMON
from tests.docs.test_quick_start import PAGE as QUICK_START
from tests.docs.test_security import PAGE as SECURITY
from utility_specs import load_specs

FRONT = [
    ROOT / name
    for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "RELIABILITY.md", "deploy/README.md", "proxy/README.md")
]
ALL = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)", re.DOTALL)


def anchor(heading):
    """Return what a link to a heading says, as GitHub has it."""
    plain = re.sub(r"[`*]|\[|\]\([^)]*\)", "", heading.strip().lower())
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


@pytest.mark.parametrize("page", [*PAGES, *FRONT], ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    """To a file that is there, and a heading in it."""
    for link in LINK.findall(page.read_text()):
        if link.startswith(("http://", "https://")):
            continue
        file, _, heading = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), link
        if heading:
            headings = {anchor(each) for each in re.findall(r"^#+ (.*)$", target.read_text(), re.MULTILINE)}
            assert heading in headings, link


def test_every_page_is_in_the_table_of_contents():
    """Who looks for it finds it."""
    contents = ROOT / "docs" / "README.md"
    linked = {(contents.parent / link).resolve() for link in LINK.findall(contents.read_text())}
    assert set(PAGES) - {contents} <= linked


@ALL
def test_examples_of_configuration_are_right(page, tmp_path):
    """As `sendworthy check` reads them; of specs as their loader does."""
    for number, shown in enumerate(blocks(page, "toml")):
        file = tmp_path / f"{number}.toml"
        for named in re.findall(r'"/etc/sendworthy/(\S+)"', shown):  # certificates, tokens: they have to be there
            there = tmp_path / named
            there.parent.mkdir(exist_ok=True)
            there.write_text("what is in such a file")
        text = shown.replace("/etc/sendworthy", str(tmp_path))
        file.write_text(text)
        if "information_type" in tomllib.loads(text):
            assert load_specs(file).types
        else:
            load_config(file, {}, {})


@ALL
def test_every_command_is_run_by_a_test(page):
    """Quick start and security from top to bottom, guides line by line; what needs root in tests of the system."""
    if page in (QUICK_START, SECURITY):
        return
    elsewhere = set(commands(ROOT / "README.md"))
    for command in commands(page):
        assert command in RUN_BESIDE_A_DAEMON | elsewhere, command


def test_troubleshooting_says_how_many_declarations_cross():
    """Who declares more finds the figures under the words of the daemon's warning."""
    page = (ROOT / "docs" / "guides" / "troubleshooting.md").read_text()
    (row,) = (line for line in page.splitlines() if "are declared |" in line)
    for what, most in BOUNDS.crossing.items():
        assert f"{most:,} {what}" in row
