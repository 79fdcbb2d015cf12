"""What is opened during a test, and closed when it ends."""

from contextlib import ExitStack

import pytest

from tests.docs.certified import NAMES, Team


@pytest.fixture
def stack():
    with ExitStack() as closing:
        yield closing


@pytest.fixture(scope="module")
def team(tmp_path_factory):
    """The robots of the security page after all of its steps, with no daemon yet."""
    with ExitStack() as closing:
        made = Team(tmp_path_factory.mktemp("security"), closing)
        for name in NAMES:
            made.control(name)
            made.swear(name)
        yield made
