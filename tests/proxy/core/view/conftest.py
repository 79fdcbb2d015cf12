"""Fixtures of the shared view."""

import pytest

from proxy.core.model.settings import CoreSettings
from proxy.core.view.view import SharedView


@pytest.fixture
def view(make_specs):
    """The view of robot r1, which knows of three streams at most."""
    return SharedView(CoreSettings("r1", "z-r1", streams=3), make_specs())
