"""Inputs that fuzzing found to go deep, or to fail once."""

from pathlib import Path

import pytest

from tests.fuzz.target import messages, one_input, seeds

CORPUS = sorted((Path(__file__).parent / "corpus").iterdir())


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_nothing_in_the_corpus_is_a_fault(path):
    """Conservation, bounds and the honest robot stand all of it."""
    one_input(path.read_bytes())


@pytest.mark.parametrize("name", seeds())
def test_the_seeds_are_understood(name):
    """They are of several messages, and each is in the corpus as it is packed now."""
    data = seeds()[name]
    assert len(messages(data)) >= 3
    one_input(data)
    assert (Path(__file__).parent / "corpus" / name).read_bytes() == data
