"""What differs between two configurations, and what of it a running daemon can take over."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from proxy.config import Config, settings
from proxy.config_secrets import without_secrets

LIVE = frozenset({("mode",), ("specs", "path"), ("log", "level")})
"""Keys that may change while the daemon runs."""


@dataclass(frozen=True, slots=True)
class Change:
    """One key with another value than before."""

    path: tuple[str, ...]
    before: Any
    after: Any

    @property
    def live(self) -> bool:
        """Whether a running daemon can take it over."""
        return self.path in LIVE

    @property
    def refusal(self) -> str:
        """Say that it cannot, with both values but for secrets."""
        values = (without_secrets(value, self.path) for value in (self.before, self.after))
        before, after = (json.dumps(value, ensure_ascii=False) for value in values)
        return f"cannot change while the daemon runs: {before} is in force, not {after}; restart it"


def changes(before: Config, after: Config) -> Iterator[Change]:
    """Yield the keys that differ, in the order of the manual."""
    dumped = tuple(config.model_dump(mode="json", by_alias=True) for config in (before, after))
    for setting in settings():
        old, new = (_at(values, setting.path) for values in dumped)
        if old != new:
            yield Change(setting.path, old, new)


def _at(values: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        values = values[name]
    return values
