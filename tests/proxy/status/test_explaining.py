"""The page that explains the status, and what the terminal shows of it."""

import re
from pathlib import Path

import pytest

from proxy.status.explaining import explained, page
from proxy.status.tables import TABLES
from proxy.status.words import GLOSSARIES

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "status.md"
WORDS = [column.head for table in TABLES for column in table.columns] + [
    word for glossary in GLOSSARIES for word in glossary.words
]


def test_the_page_is_what_the_code_says():
    """Made anew with `python -m proxy.status.explaining > docs/reference/status.md`."""
    assert PAGE.read_text() == page()


@pytest.mark.parametrize("width", [40, 80, 160])
def test_the_terminal_shows_every_column_and_word(width):
    """At any width."""
    text = explained(width)
    assert max(map(len, text.splitlines())) <= width
    for word in WORDS:
        assert re.search(rf"^  {re.escape(word)}(  |$)", text, re.MULTILINE), word
        assert f"| {word} | " in page()
