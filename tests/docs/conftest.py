"""The robots of the security page."""

from contextlib import ExitStack

import pytest

from tests.docs.certified import NAMES, Team


@pytest.fixture(scope="module")
def team(tmp_path_factory):
    """The robots of the security page after all of its steps, with no daemon yet."""
    with ExitStack() as closing:
        made = Team(tmp_path_factory.mktemp("security"), closing)
        for name in NAMES:
            made.control(name)
            made.swear(name)
        yield made
