"""Inputs that fuzzing found to go deep, or to fail once."""

from pathlib import Path

import pytest

from tests.fuzz import payload_target
from tests.fuzz.target import messages, seeds
from tests.fuzz.targets import TARGETS

CORPUS = Path(__file__).parent / "corpus"
KEPT = sorted(CORPUS.glob("*/*"))
FIRST = {"mesh", "specs", "expressions"}
"""Whose seeds are tried elsewhere."""


@pytest.mark.parametrize("path", KEPT, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_nothing_in_the_corpus_is_a_fault(path):
    """Whatever it is of: nothing raises but what says what is wrong."""
    one, _ = TARGETS[path.parent.name]
    one(path.read_bytes())


@pytest.mark.parametrize("what", sorted(TARGETS.keys() - FIRST))
def test_the_seeds_are_no_faults(what):
    """Fuzzing starts from them."""
    one, seeds_of = TARGETS[what]
    for data in seeds_of():
        one(data)


@pytest.mark.parametrize("seeds_of", [payload_target.payload_seeds, payload_target.image_seeds])
def test_the_seeds_have_features(seeds_of):
    """Some of each kind of payload are found, so what is mangled goes deep."""
    keys = payload_target.IMAGES if seeds_of is payload_target.image_seeds else payload_target.PAYLOADS
    types = {key: payload_target.specs().match(key) for key in keys}
    lacking = set(keys)
    for data in seeds_of():
        key, before = keys[data[0]], types[keys[data[0]]].failures.counts()
        types[key].extract(key, data[1:], data[1:])
        failed = [name for name, count in types[key].failures.counts().items() if count > before.get(name, 0)]
        if len(failed) < len(types[key].features):
            lacking.discard(key)
    assert not lacking


@pytest.mark.parametrize("name", seeds())
def test_the_seeds_are_understood(name):
    """They are of several messages, and each is in the corpus as it is packed now."""
    data = seeds()[name]
    assert len(messages(data)) >= 3
    TARGETS["mesh"][0](data)
    assert (CORPUS / "mesh" / name).read_bytes() == data
