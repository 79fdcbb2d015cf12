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


@pytest.fixture
def now(monkeypatch):
    """What the clock shows."""
    shown = [100.0]
    monkeypatch.setattr("proxy.clock.monotonic", lambda: shown[0])
    return shown
