"""A second session beside a main one, linked to it through a tap.

Zenoh has no way to ask who subscribes to what that is safe: its admin space answers while it holds the routing tables,
and a declaration that comes at that moment blocks the session for ever. But a node is told every declaration of all
others, so one link on which we can read them tells everything, as it happens, and exactly: what a node declares
itself it is not told. So the voice declares what mirrors the other side.
"""

import logging
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from typing import Any, Literal

import zenoh

from proxy.bridge.declaration import Declaration
from proxy.bridge.door import Door
from proxy.bridge.keys import PREFIX
from proxy.bridge.ledger import Ledger
from proxy.bridge.sessions import open_session, voice_options
from proxy.bridge.sourcing import MOST_BEFORE, enclosed
from proxy.bridge.tap import Tap
from proxy.bridge.trial import gives_source
from proxy.bridge.widening import EVERYTHING
from proxy.bridge.wire import Kind
from proxy.errors import SessionError

log = logging.getLogger(__name__)

_PATIENCE = 2.0
"""How long the interests of a voice may take to its main session [s]; they take a few milliseconds."""


_REFUSED = (
    "the daemon cannot link to its own session; with transport.auth.usrpwd, its user and password must be in its own "
    "dictionary_file too"
)


class Voice:
    """The voice of the session `main`, which listens at `door`.

    A router is told everything; a client, for which alone peers route, what it says it is interested in: `widening`
    makes that everything. `changed` is called when `declared` changes. Raises SessionError, naming `side`.
    """

    def __init__(
        self,
        main: zenoh.Session,
        door: Door,
        *,
        side: Literal["app", "mesh"],
        mode: Literal["router", "client"],
        zenoh_options: Mapping[str, Any],
        changed: Callable[[], None],
    ) -> None:
        door.hide()
        self.ledger = Ledger(changed)
        self.echoes = mode == "client"
        """Whether tokens of the voice itself are among those declared."""
        self._closing = ExitStack()
        told = (self._publish, self._ask, self._attend) if mode == "client" else ()
        tap = Tap(door.tap, door.main, self.ledger, interests=len(told))
        self._closing.callback(tap.close)
        options = voice_options(mode, f"unixsock-stream/{door.tap}", zenoh_options)
        try:
            self.session = open_session(options, "voice")
        except SessionError as error:
            self._closing.close()
            raise SessionError(f"{side}.zenoh: {_REFUSED}: {error}") from error
        self._closing.callback(self.session.close)
        self._interests: list[Declaration] = [declare(EVERYTHING) for declare in told]
        if told and not tap.widened.wait(_PATIENCE):
            self.ledger.give_up("the voice's interests are written in another way")
        self._mark = tap.mark
        # A router works out its routes a tenth of a second after it is linked: what else a start takes need not wait.
        trial = ThreadPoolExecutor(1, "trial")
        self._sourced = trial.submit(_sourced, main, self.session, tap.mark, side)
        trial.shutdown(wait=False)

    @property
    def sourced(self) -> bool:
        """Whether replies can have source info; waits until it is known."""
        return self._sourced.result()

    def attachment_of(self, sample: zenoh.Sample) -> zenoh.ZBytes | bytes | None:
        """Return the attachment with which `sample` is to be replied, so that the reply has its source info too."""
        info, attachment = sample.source_info, sample.attachment
        if info is None or not self.sourced:
            return attachment
        if len(f"{sample.key_expr}{sample.encoding}".encode()) > MOST_BEFORE:
            return attachment
        return enclosed(self._mark, info, None if attachment is None else bytes(attachment))

    def declared(self, kind: Kind) -> Mapping[str, bool]:
        """Return what others declared to the main session, and subscribers of its own; for queryables whether complete.

        The same mapping until something changes.
        """
        return self.ledger.declared(kind)

    def close(self) -> None:
        """Fall silent: everything declared with the voice is gone."""
        wait((self._sourced,))
        for interest in self._interests:
            interest.undeclare()
        self._interests = []
        self._closing.close()

    def _publish(self, key: str) -> Declaration:
        """Be told of subscribers."""
        return self.session.declare_publisher(key)

    def _ask(self, key: str) -> Declaration:
        """Be told of queryables."""
        return self.session.declare_querier(key)

    def _attend(self, key: str) -> Declaration:
        """Be told of tokens."""
        handler = zenoh.handlers.Callback(_ignore, indirect=False)
        return self.session.liveliness().declare_subscriber(key, handler, history=True)


def _sourced(main: zenoh.Session, voice: zenoh.Session, mark: bytes, side: str) -> bool:
    found = gives_source(main, voice, mark)
    if not found:
        log.error(
            "%s.zenoh: cannot give replies source info, so the numbers of advanced publishers stay on their robots;"
            " access_control must allow %s/trial/**",
            side,
            PREFIX,
        )
    return found


def _ignore(_: zenoh.Sample) -> None:
    """The ledger has read it already."""
