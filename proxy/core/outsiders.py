"""Robots that share other limits than we do, for they have other specs: nobody of us can share with them."""

from proxy.core.view import SharedView
from proxy.core.wire import tag

PATIENCE = 5.0
"""Specs may be changed on one robot after the other within this time [s]."""


class Outsiders:
    """Who has had other limits for long. Robots are named by their tags."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._since: dict[str, float] = {}
        self.found: frozenset[str] = frozenset()

    def note(self, now: float, name: str, *, known: bool) -> None:
        """A robot told of its epoch; `known` when that is one of the limits that we have."""
        if known or not self._differs(name):
            self._since.pop(name, None)
        else:
            self._since.setdefault(name, now)

    def look(self, now: float) -> bool:
        """Look who has had other limits for too long; return whether these are others than before."""
        if not self._since and not self.found:
            return False
        self._since = {name: since for name, since in self._since.items() if self._differs(name)}
        before, self.found = self.found, frozenset(n for n, since in self._since.items() if now - since > PATIENCE)
        return self.found != before

    def _differs(self, name: str) -> bool:
        """Whether a robot is there and has other specs by now: both may have changed since it told of its epoch."""
        peer = self._view.peers.get(name)
        return peer is not None and peer.specs not in ("", self._view.specs.generation)

    def warnings(self) -> list[str]:
        """Name them."""
        peers = self._view.peers.values()
        return [
            f"robot {peer.robot} has other limits (specs {peer.specs}, here {self._view.specs.generation}): nothing "
            "keeps what it sends and what others send within either; give all robots the same constraints"
            for peer in peers
            if tag(peer.zid) in self.found
        ]
