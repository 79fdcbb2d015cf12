"""Keeps pydantic from looking for plugins: `importlib.metadata`, which it takes for that, is 1.7 MB of every daemon.

Pydantic imports what looks for them, a module of its own, when it makes the first model. So in its place there is one
that knows of none. Should pydantic want anything else of it, it gets its own.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

LOADER = "pydantic.plugin._loader"


class NoPlugins(ModuleType):
    """Stands in for the module of pydantic that looks for plugins."""

    @staticmethod
    def get_plugins() -> tuple[()]:
        """Return all plugins there are."""
        return ()

    def __getattr__(self, name: str) -> Any:
        """Return what only pydantic's own module has."""
        if name.startswith("__"):
            raise AttributeError(name)
        if sys.modules.get(LOADER) is self:
            del sys.modules[LOADER]
        return getattr(import_module(LOADER), name)


def leave_out() -> None:
    """Have pydantic find no plugins, if it did not look for them before."""
    sys.modules.setdefault(LOADER, NoPlugins(LOADER))
