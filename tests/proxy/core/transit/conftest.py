"""Fixtures of what is heard of another robot."""

import pytest

from proxy.core.view.peer import Peer
from tests.proxy.core.transit.heard import hear_digest, state


@pytest.fixture
def peer():
    """Robot r2: its clock shows 100 s less than ours, its wall clock 1,000 s more than its own; digests take 10 ms."""
    made = Peer("r2", "z-r2", 0.0)
    made.take_state(0.0, state(1000.0))
    hear_digest(made, 1.0)
    return made
