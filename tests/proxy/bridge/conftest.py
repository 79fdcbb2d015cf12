import pytest

from tests.proxy.bridge import robots


@pytest.fixture
def team(stack, tmp_path):
    """Three robots on a full mesh."""
    return robots.team(stack, tmp_path)


@pytest.fixture
def pair(stack, tmp_path):
    """Two linked robots."""
    return robots.team(stack, tmp_path, size=2)
