"""A scene for each test."""

import pytest

from tests.faults.scene import Scene


@pytest.fixture
def play(tmp_path, stack):
    """Set up a scene; it ends with the test."""

    def play_one(**how):
        return Scene(tmp_path, stack, **how)

    return play_one
