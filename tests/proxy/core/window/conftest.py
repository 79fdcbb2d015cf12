"""Views that several tests of windows begin with."""

import pytest

from tests.proxy.core.window.views import add_stream, make_view


@pytest.fixture
def crowd(make_specs):
    """Our stream and those of two others, which the apps here want."""
    view = make_view(make_specs())
    view.subscribers.set_own(("robot/**",))
    for robot in ("r1", "r2", "r3"):
        add_stream(view, robot)
    return view
