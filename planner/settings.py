"""Refuses settings that have no meaning, naming what is wrong."""

from planner.errors import SearchError
from planner.finite import finite
from planner.search import SearchSettings


def check_settings(settings: SearchSettings) -> None:
    """Raise SearchError for settings that no engine can follow."""
    choices = (
        ("search", settings.search, ("best", "paper")),
        ("engine", settings.engine, ("native", "python")),
        ("reduction", settings.reduction, ("off", "paper", "exact")),
    )
    for name, value, known in choices:
        if value not in known:
            raise SearchError(f"{name} must be one of {', '.join(known)}, not {value!r}")
    if not (finite(settings.exploration) and settings.exploration >= 0):
        raise SearchError(f"exploration must be a finite number >= 0, not {settings.exploration!r}")
    if not (isinstance(settings.max_nodes, int) and 1 <= settings.max_nodes <= 2**24):
        raise SearchError(f"max_nodes must be a whole number from 1 to {2**24:,}, not {settings.max_nodes!r}")
