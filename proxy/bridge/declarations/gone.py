"""What is still declared when a router has gone: routers do not tell each other that what was behind it is gone, too.

Each session knows it of itself, and is asked: by the matching status of a publisher and of a querier, and for tokens.
"""

from collections.abc import Iterable

import zenoh

from proxy.bridge.declaration import matches
from proxy.bridge.declarations.wire import Kind
from proxy.bridge.keys import CROSSING

_REMOTE = zenoh.Locality.REMOTE


def gone(session: zenoh.Session, kind: Kind, told: Iterable[str]) -> set[str]:
    """Return what nobody else declares any more to `session`, of what was `told`."""
    if kind == "token":
        missing = set(told).difference(*(_alive(session, expression) for expression in CROSSING))
        return {token for token in missing if not _alive(session, token)}
    return {expression for expression in told if not _declared(session, kind, expression)}


def _alive(session: zenoh.Session, expression: str) -> set[str]:
    """Return the tokens that match, in one question: there may be thousands."""
    return {str(reply.ok.key_expr) for reply in session.liveliness().get(expression) if reply.ok is not None}


def _declared(session: zenoh.Session, kind: Kind, expression: str) -> bool:
    declare = session.declare_querier if kind == "queryable" else session.declare_publisher
    asker = declare(expression, allowed_destination=_REMOTE)
    try:
        return matches(asker)
    finally:
        asker.undeclare()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs
