"""Our own tokens, which Zenoh echoes to a client, and for a moment after their end."""

from collections.abc import Collection, Mapping

from proxy.bridge.declarations.tuning import TUNING


class Echoes:
    """Tells the tokens of others from those of a mirror session that is a client."""

    def __init__(self) -> None:
        self._own: dict[str, float] = {}
        """Until when each token of ours may be echoed [s]."""

    def waiting(self, own: Collection[str]) -> bool:
        """Whether some that have ended may still be echoed; `own` is what there is now."""
        return len(self._own) > len(own)

    def ended(self, ended: set[str], own: Collection[str]) -> set[str]:
        """Leave ours, which are `own` now, out of all that have ended."""
        return ended.difference(own, self._own)

    def without(
        self, alive: Mapping[str, bool], own: Collection[str], now: float, kept: Collection[str] = ()
    ) -> Mapping[str, bool]:
        """Leave ours, which are `own` now, out of all that are alive; not those of others too, if they are `kept`."""
        self._own |= dict.fromkeys(own, now + TUNING.echo)
        self._own = {token: until for token, until in self._own.items() if until > now}
        return {token: False for token in alive if token not in self._own or token in kept}
