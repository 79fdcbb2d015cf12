"""Takes queries across: queryables of one side are declared on the other, and answered by asking them."""

import threading
from collections.abc import Mapping
from functools import partial

import zenoh

from proxy.bridge.lane import Lane
from proxy.bridge.mirror import Mirror
from proxy.bridge.owners import Owners
from proxy.bridge.rules import Way

MOST_PENDING = 1024
"""Queries under way in one direction; more are answered with an error."""
TIMEOUT = 60.0
"""The asker's own timeout is not ours to see; it ends a query sooner, a dead answerer does too [s]."""


class Queries:
    """One direction: queries that nodes of `near` ask for what nodes of `far` answer.

    `way` is the one that the answers go: a query for what it denies is not answered, as if nobody did.
    """

    def __init__(self, near: zenoh.Session, far: zenoh.Session, lane: Lane, way: Way) -> None:
        self._near = near
        self._far = far
        self._lane = lane
        self._way = way
        self._owners = Owners()
        self._mirror = Mirror(self._declare, self._owners.discard)
        self._pending = 0
        self._lock = threading.Lock()
        self.crossed = 0

    @property
    def expressions(self) -> tuple[str, ...]:
        """What we answer on the near side."""
        return self._mirror.expressions

    def update(self, answered: Mapping[str, bool]) -> bool:
        """Answer what the far side answers now; return whether that is news."""
        return self._mirror.update(answered)

    def close(self) -> None:
        """Answer nothing more."""
        self._mirror.close()

    def _declare(self, expression: str, complete: bool) -> zenoh.Queryable[None]:  # noqa: FBT001 - as Mirror calls it
        self._owners.add(expression)
        handler = zenoh.handlers.Callback(partial(self._receive, expression), indirect=False)
        return self._near.declare_queryable(
            expression, handler, complete=complete, allowed_origin=zenoh.Locality.REMOTE
        )

    def _receive(self, expression: str, query: zenoh.Query) -> None:
        # Of several queryables that a query reaches here one asks everybody on the far side.
        asked = str(query.key_expr)
        if self._owners.owner(asked) != expression or not self._way.admits("queries", asked):
            query.drop()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs
            return
        with self._lock:
            self._pending += 1
        if self._pending > MOST_PENDING or not self._lane.offer(partial(self._ask, query)):
            query.reply_err("too many queries under way")
            self._end(query)

    def _ask(self, query: zenoh.Query) -> None:
        self.crossed += 1
        handler = zenoh.handlers.Callback(partial(self._reply, query), partial(self._finish, query), indirect=False)
        try:
            self._far.get(
                query.selector,
                handler,
                target=zenoh.QueryTarget.ALL,
                consolidation=zenoh.ConsolidationMode.NONE,
                accept_replies=query.accepts_replies(),
                timeout=TIMEOUT,
                payload=query.payload,
                encoding=query.encoding,
                attachment=query.attachment,
                source_info=query.source_info,
                allowed_destination=zenoh.Locality.REMOTE,
            )
        except zenoh.ZError as error:
            query.reply_err(str(error))
            self._finish(query)

    def _reply(self, query: zenoh.Query, reply: zenoh.Reply) -> None:
        if reply.ok is None or self._way.admits("replies", str(reply.ok.key_expr)):
            self._lane.offer(partial(_answer, query, reply))

    def _finish(self, query: zenoh.Query) -> None:
        self._lane.insist(partial(self._end, query))

    def _end(self, query: zenoh.Query) -> None:
        with self._lock:
            self._pending -= 1
        query.drop()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs


def _answer(query: zenoh.Query, reply: zenoh.Reply) -> None:
    sample, error = reply.ok, reply.err
    if sample is not None and sample.kind == zenoh.SampleKind.DELETE:
        query.reply_del(
            sample.key_expr, express=sample.express, attachment=sample.attachment, timestamp=sample.timestamp
        )
    elif sample is not None:
        query.reply(
            sample.key_expr,
            sample.payload,
            encoding=sample.encoding,
            express=sample.express,
            attachment=sample.attachment,
            timestamp=sample.timestamp,
        )
    elif error is not None:
        query.reply_err(error.payload, encoding=error.encoding)
