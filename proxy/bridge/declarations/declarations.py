"""What others declare on one side, and a session there that declares what mirrors the other side."""

from collections.abc import Callable, Collection, Mapping
from typing import Any, Literal

import zenoh

from proxy.bridge.declarations.echoes import Echoes
from proxy.bridge.declarations.gone import gone
from proxy.bridge.declarations.markers import Job, Markers
from proxy.bridge.declarations.mirror_session import MirrorSession
from proxy.bridge.declarations.private_endpoint import PrivateEndpoint
from proxy.bridge.declarations.query_options import QueryOptions, options_of
from proxy.bridge.declarations.table import DeclarationTable
from proxy.bridge.declarations.wire import Kind
from proxy.bridge.declarations.witnesses import Witnesses
from proxy.bridge.keys import CROSSING, INGRESS, marker


class Declarations:
    """Follows what is declared to the session `main`, which listens at `endpoint`.

    `mode` is that of `session`, which stands beside `main`: a router is told everything, a client is told its own
    tokens, too. `changed` is called when `edition` grows. Should the wire not be understood, everything counts as
    subscribed to. Raises SessionError, naming `side`.
    """

    def __init__(
        self,
        main: zenoh.Session,
        endpoint: PrivateEndpoint,
        *,
        side: Literal["app", "mesh"],
        mode: Literal["router", "client"],
        zenoh_options: Mapping[str, Any],
        changed: Callable[[], None],
    ) -> None:
        self._everything = CROSSING if side == "app" else INGRESS
        self._side = side
        self._main = main
        self._table = DeclarationTable(changed)
        self._mirror = MirrorSession(main, endpoint, self._table, side=side, mode=mode, zenoh_options=zenoh_options)
        self._witnesses = Witnesses(main, changed)
        self._echoes = Echoes() if mode == "client" else None
        self.session = self._mirror.session
        """Declares what mirrors the other side: what it declares itself it is not told."""
        self._markers = Markers(main, self.session, marker(str(main.zid())))

    @property
    def edition(self) -> int:
        """Grows with every change of what is declared."""
        return self._table.edition

    def warnings(self) -> list[str]:
        """Say that what is declared cannot be followed any more, if so."""
        what = "applications" if self._side == "app" else "other robots"
        news = (
            f"what {what} declare cannot be followed: new queryables and tokens of theirs do not cross until a restart"
        )
        return [news] if self._table.broken else []

    @property
    def keeps_source(self) -> bool:
        """Whether replies can have source info; waits until it is known."""
        return self._mirror.keeps_source

    def declared(self, kind: Kind) -> Mapping[str, bool]:
        """Return what was declared to the main session, and subscribers of its own; for queryables whether complete.

        The same mapping until something changes.
        """
        return self._table.declared(kind)

    def foreign_subscribers(self, own: Collection[str], now: float) -> dict[str, bool]:
        """Return what others subscribe to, `own` being what the main session does."""
        found = self._witnesses.others(self.declared("subscriber"), own, now)
        return found | dict.fromkeys(self._everything, False) if self._table.broken else found

    def foreign_tokens(self, own: Collection[str], now: float, kept: Collection[str] = ()) -> Mapping[str, bool]:
        """Return the tokens of others, `own` being those of `session`.

        Of a name that is ours nobody tells whether it is somebody else's, too. One of those that are `kept` was so
        before it was ours, and is taken to be so until ours has ended.
        """
        alive = self.declared("token")
        return alive if self._echoes is None else self._echoes.without(alive, own, now, kept)

    def ended_tokens(self, own: Collection[str]) -> set[str]:
        """Return the tokens of others that ended since the last call: they may be alive again by now."""
        ended = self._table.ended_tokens()
        return ended if self._echoes is None else self._echoes.ended(ended, own)

    def forget_gone(self, own: Collection[str]) -> None:
        """Forget what was behind a router that is gone; `own` is what the main session subscribes to."""
        kinds: tuple[Kind, ...] = ("subscriber", "queryable", "token")
        for kind in kinds:
            told = self._table.entries(kind)
            expressions = {entry[0] for entry in told.values()} - set(own if kind == "subscriber" else ())
            if found := gone(self._main, kind, expressions):
                self._table.remove(kind, {name: entry for name, entry in told.items() if entry[0] in found})

    def ask_witnesses(self) -> bool:
        """Whether somebody wants by now what only we did, or nobody does any more: the wire tells a moment later."""
        return self._witnesses.ask()

    def unsettled(self, tokens: Collection[str]) -> bool:
        """Whether what we declared or took back is not told yet; `tokens` are those of `session`."""
        return self._witnesses.waiting or (self._echoes is not None and self._echoes.waiting(tokens))

    def query_options(self, expression: str, parameters: str) -> QueryOptions:
        """Return what `take_query` would."""
        return options_of(self._table.asked(expression, parameters))

    def take_query(self, expression: str, parameters: str) -> QueryOptions:
        """Return how the oldest query that is not taken yet was asked."""
        return options_of(self._table.take(expression, parameters))

    def attachment_of(self, sample: zenoh.Sample) -> zenoh.ZBytes | bytes | None:
        """Return the attachment with which `sample` is to be replied, so that the reply has its source info too."""
        return self._mirror.attachment_of(sample)

    def after_told(self, job: Job) -> None:
        """Call `job` when the table has all that is declared to the main session by now."""
        self._markers.after_told(job)

    def after_taken(self, job: Job) -> None:
        """Call `job` when the main session knows of all that `session` has declared by now, and tells of it first."""
        self._markers.after_taken(job)

    def close(self) -> None:
        """Take back everything that was declared with `session`."""
        self._markers.close()
        self._witnesses.close()
        self._mirror.close()
