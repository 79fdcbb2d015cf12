"""The words of the status."""

import re
from pathlib import Path

from proxy.core.model.mode import Mode
from proxy.status.words import GLOSSARIES, MODES, REASONS, reason

PROXY = Path(__file__).parents[3] / "proxy"


def test_every_reason_that_the_daemon_gives_is_explained():
    """As they stand in its source."""
    found = {
        word
        for source in PROXY.rglob("*.py")
        if source.name != "words.py"
        for word in re.findall(r'"((?:dropped|passed):[a-z-]+)"', source.read_text())
    }
    assert len(found) > 15
    assert found | {"forwarded"} == REASONS.words.keys()


def test_every_mode_is_explained():
    """There are three."""
    assert {mode.value for mode in Mode} == MODES.words.keys()


def test_explanations_are_short():
    """They stand beside their words at 80 columns."""
    for glossary in GLOSSARIES:
        assert max(map(len, glossary.words.values())) < 120


def test_a_word_of_another_version_has_no_explanation():
    """It is shown as it is."""
    assert reason("dropped:planner")
    assert reason("dropped:later") == ""
