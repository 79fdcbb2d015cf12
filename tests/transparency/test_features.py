"""What applications see with a daemon on each robot is what they see with a Zenoh router on each."""

import os

import pytest

from tests.transparency import table
from tests.transparency.feature import FEATURES, differences
from tests.transparency.probes import (
    advanced,
    liveliness,
    matching,
    publishing,
    queries,
    subscribing,
    surroundings,
    targets,
)

pytestmark = pytest.mark.system

REWRITE = "WRITE_TRANSPARENCY"
"""The environment variable with which the page is written instead of compared."""
GROUPS = (publishing, subscribing, matching, queries, targets, liveliness, advanced, surroundings)
"""Importing them fills FEATURES; the page has them in this order."""
FEATURES.sort(key=lambda feature: [module.GROUP for module in GROUPS].index(feature.group))


@pytest.mark.parametrize("feature", FEATURES, ids=[f"{feature.group}: {feature.name}" for feature in FEATURES])
def test_daemons_are_like_routers(seen, feature):
    """Nothing differs but what is known to, and that does."""
    found = seen(feature)
    differs = differences(found["routers"], found["daemons"])
    news = {name: pair for name, pair in differs.items() if feature.known.get(name) != pair}
    assert not news, "differs, and no limit says so (routers, daemons)"
    gone = feature.known.keys() - differs.keys()
    assert not gone, "does not differ any more: take it out of the limits"


def test_the_page_says_what_was_found(seen):
    """deploy/TRANSPARENCY.md is what this run writes; `make transparency` renews it."""
    written = table.page({feature: seen(feature) for feature in FEATURES})
    if REWRITE in os.environ:
        table.PAGE.write_text(written)
    assert table.PAGE.read_text() == written, "run make transparency"
