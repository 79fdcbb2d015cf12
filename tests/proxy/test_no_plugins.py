"""Pydantic finds no plugins, without looking for them."""

import sys

import pytest

from proxy.no_plugins import LOADER, NoPlugins, leave_out


@pytest.fixture
def absent(monkeypatch):
    """As if nobody had looked for plugins yet."""
    monkeypatch.setitem(sys.modules, LOADER, None)
    del sys.modules[LOADER]


@pytest.mark.usefixtures("absent")
def test_pydantic_is_given_what_knows_of_no_plugins():
    """So does pydantic ask."""
    leave_out()
    from pydantic.plugin._loader import get_plugins  # noqa: PLC0415 - that is the question

    assert get_plugins() == ()
    assert isinstance(sys.modules[LOADER], NoPlugins)


@pytest.mark.usefixtures("absent")
def test_where_pydantic_wants_more_it_gets_its_own():
    """Its next version may."""
    leave_out()
    from pydantic.plugin._loader import PYDANTIC_ENTRY_POINT_GROUP  # noqa: PLC0415 - that is the question

    assert PYDANTIC_ENTRY_POINT_GROUP == "pydantic"
    assert not isinstance(sys.modules[LOADER], NoPlugins)


@pytest.mark.usefixtures("absent")
def test_who_only_looks_at_modules_loads_nothing():
    """As `inspect` does with all of them."""
    leave_out()
    assert not hasattr(sys.modules[LOADER], "__file__")
    assert isinstance(sys.modules[LOADER], NoPlugins)


def test_what_pydantic_has_loaded_stays(monkeypatch):
    """Somebody may use it beside the daemon."""
    monkeypatch.setitem(sys.modules, LOADER, sys)
    leave_out()
    assert sys.modules[LOADER] is sys
