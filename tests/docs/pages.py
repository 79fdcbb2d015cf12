"""The pages of the manual, and what stands in them."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))


def blocks(page, language):
    """Return the code blocks of a page in a language."""
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL)


def commands(page):
    """Return what is typed on a page: a line each, without comments."""
    lines = [re.split(r"(?:^| )#", line)[0].strip() for block in blocks(page, "sh") for line in block.splitlines()]
    return [line for line in lines if line]
