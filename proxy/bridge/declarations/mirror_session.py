"""A second session beside a main one, linked to it through a tap.

Zenoh has no way to ask who subscribes to what that is safe: its admin space answers while it holds the routing tables,
and a declaration that comes at that moment blocks the session for ever. But a node is told every declaration of all
others, so one link on which we can read them tells everything, as it happens, and exactly: what a node declares
itself it is not told. So the mirror session declares what mirrors the other side.
"""

import logging
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from typing import Any, Literal

import zenoh

from proxy.bridge.declaration import Declaration
from proxy.bridge.declarations.private_endpoint import PrivateEndpoint
from proxy.bridge.declarations.source_info import enclosed
from proxy.bridge.declarations.table import DeclarationTable
from proxy.bridge.declarations.tap import DeclarationTap
from proxy.bridge.declarations.trial import gives_source
from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.widening import EVERYTHING
from proxy.bridge.keys import CROSSING, PREFIX
from proxy.bridge.sessions import mirror_options, open_session
from proxy.errors import SessionError

log = logging.getLogger(__name__)

_REFUSED = (
    "the daemon cannot link to its own session; with transport.auth.usrpwd, its user and password must be in its own "
    "dictionary_file too"
)


class MirrorSession:
    """The mirror session of `main`, which listens at `endpoint`; `table` gets what is declared.

    A router is told everything; a client, for which alone peers route, what it says it is interested in: `widening`
    makes that everything. Raises SessionError, naming `side`.
    """

    def __init__(
        self,
        main: zenoh.Session,
        endpoint: PrivateEndpoint,
        table: DeclarationTable,
        *,
        side: Literal["app", "mesh"],
        mode: Literal["router", "client"],
        zenoh_options: Mapping[str, Any],
    ) -> None:
        self._closing = ExitStack()
        interests = (self._subscribers, self._queryables, self._tokens) if mode == "client" else ()
        tap = DeclarationTap(endpoint.tap, endpoint.main, table, interests=len(interests))
        self._closing.callback(tap.close)
        options = mirror_options(mode, f"unixsock-stream/{endpoint.tap}", zenoh_options)
        try:
            self.session = open_session(options, "mirror session")
        except SessionError as error:
            self._closing.close()
            raise SessionError(f"{side}.zenoh: {_REFUSED}: {error}") from error
        self._closing.callback(self.session.close)
        self._interests: list[Declaration] = [declare(EVERYTHING) for declare in interests]
        if interests and not tap.widened.wait(TUNING.interests_timeout):
            table.give_up("the interests of the mirror session are written in another way")
        if interests and zenoh_options.get("access_control", {}).get("enabled"):
            # Zenoh's access control lets no interest in tokens pass that names no key, whatever its rules say.
            self._interests += [self._tokens(key) for key in CROSSING]
        self._mark = tap.mark
        # A router works out its routes a tenth of a second after it is linked: what else a start takes need not wait.
        trial = ThreadPoolExecutor(1, "trial")
        self._trial = trial.submit(_gives_source, main, self.session, tap.mark, side)
        trial.shutdown(wait=False)

    @property
    def keeps_source(self) -> bool:
        """Whether replies can have source info; waits until it is known."""
        return self._trial.result()

    def attachment_of(self, sample: zenoh.Sample) -> zenoh.ZBytes | bytes | None:
        """Return the attachment with which `sample` is to be replied, so that the reply has its source info too."""
        info, attachment = sample.source_info, sample.attachment
        if info is None or not self.keeps_source:
            return attachment
        if len(f"{sample.key_expr}{sample.encoding}".encode()) > TUNING.key_and_encoding:
            return attachment
        return enclosed(self._mark, info, None if attachment is None else bytes(attachment))

    def close(self) -> None:
        """Close the session: everything declared with it is gone."""
        wait((self._trial,))
        for interest in self._interests:
            interest.undeclare()
        self._interests = []
        self._closing.close()

    def _subscribers(self, key: str) -> Declaration:
        """Be told of subscribers: a publisher is."""
        return self.session.declare_publisher(key)

    def _queryables(self, key: str) -> Declaration:
        """Be told of queryables: a querier is."""
        return self.session.declare_querier(key)

    def _tokens(self, key: str) -> Declaration:
        """Be told of tokens."""
        handler = zenoh.handlers.Callback(_ignore, indirect=False)
        return self.session.liveliness().declare_subscriber(key, handler, history=True)


def _gives_source(main: zenoh.Session, mirror: zenoh.Session, mark: bytes, side: str) -> bool:
    found = gives_source(main, mirror, mark)
    if not found:
        log.error(
            "%s.zenoh: cannot give replies source info, so the numbers of advanced publishers stay on their robots;"
            " access_control must allow %s/trial/**",
            side,
            PREFIX,
        )
    return found


def _ignore(_: zenoh.Sample) -> None:
    """The table has it already."""
