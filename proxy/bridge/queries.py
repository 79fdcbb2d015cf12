"""Takes queries across: queryables of one side are declared on the other, and answered by asking them.

A query is asked on as it was asked: Zenoh's interface does not tell how, but the `Declarations` of the near side do.
Only consolidation is left to the asker, who consolidates what comes back in any case: doing it twice would only hold
replies up. There is no message for a query that its asker gave up: it ends with its answers or its timeout, as between
routers.
"""

import logging
from collections.abc import Callable, Mapping
from functools import partial

import zenoh

from proxy.bridge.barrier import Barrier
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration
from proxy.bridge.declarations.declarations import Declarations
from proxy.bridge.declarations.query_options import QueryOptions
from proxy.bridge.deduplication import Deduplication, of_query
from proxy.bridge.fence import Fence
from proxy.bridge.mirror import Mirror
from proxy.bridge.rules import ADVANCED, Direction
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)

Ahead = tuple[Barrier, Barrier]

_NUMBERS = "_sn"
"""The parameter with which an advanced subscriber asks for samples by their numbers."""


class Queries:
    """One direction: queries that nodes of `near` ask for what nodes of `far` answer.

    What the session `far` asks reaches all but itself, so a query never comes back to who mirrors it. A query is not
    asked on before `fence` says that what was declared before it is mirrored. `direction` is that of the answers: a
    query for what it denies, or for keys whose queries are `dropped`, is not answered, as if nobody did. Where the
    samples of a key are not `numbered` neither are replies, and what has nothing but a number does not cross: nobody
    could tell that they have it already. `ahead` are the barriers of samples that go the way of queries, and of those
    that go the way of replies: what they hold is not overtaken.
    """

    def __init__(
        self,
        near: Declarations,
        far: zenoh.Session,
        executor: SerialExecutor,
        fence: Fence,
        direction: Direction,
        *,
        dropped: Callable[[str], bool],
        numbered: Callable[[str], bool],
        ahead: Ahead,
    ) -> None:
        self._near = near
        self._far = far
        self._executor = executor
        self._fence = fence
        self._direction = direction
        self._dropped = dropped
        self._numbered = numbered
        self._asked_behind, self._answered_behind = ahead
        self._deduplication = Deduplication(of_query)
        self._mirror = Mirror(self._declare)
        self._pending: dict[int, tuple[zenoh.Query, int]] = {}
        """By its id each query under way, and the number of the queryable that it came to."""
        self.crossed = 0

    @property
    def pending(self) -> int:
        """Queries under way."""
        return len(self._pending)

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

    def _declare(self, expression: str, complete: bool) -> Declaration:  # noqa: FBT001 - as Mirror calls it
        near, remote = self._near.session, zenoh.Locality.REMOTE
        answer = partial(near.declare_queryable, expression, complete=complete, allowed_origin=remote)
        return self._deduplication.declare(expression, self._receive, answer, complete=complete)

    def _receive(self, number: int, query: zenoh.Query) -> None:
        # Of several queryables that a query reaches here one asks everybody on the far side.
        key = str(query.key_expr)
        parameters = str(query.parameters)
        options = self._near.query_options(key, parameters)
        if not self._deduplication.takes(number, key, query, complete=options.complete):
            query.drop()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs
            return
        self._near.take_query(key, parameters)
        if not self._admits(key) or self._by_number(key, query):
            query.drop()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs
            return
        self._pending[id(query)] = query, number
        if self.pending > BOUNDS.queries or self._too_many(number):
            self._refuse(query)
        else:
            behind = self._asked_behind.newest
            self._fence.then(partial(self._pass_on, query, options, behind))

    def _too_many(self, number: int) -> bool:
        """Whether too many queries came to one queryable."""
        if self.pending <= BOUNDS.queries_of_one:
            return False
        return sum(of == number for _, of in list(self._pending.values())) > BOUNDS.queries_of_one

    def _pass_on(self, query: zenoh.Query, options: QueryOptions, behind: int) -> None:
        if not self._executor.offer(partial(self._ask, query, options, behind)):
            self._refuse(query)

    def _refuse(self, query: zenoh.Query) -> None:
        query.reply_err("too many queries under way")
        self._end(query)

    def _admits(self, key: str) -> bool:
        """Whether a query for `key` crosses; it is counted when not."""
        if not self._dropped(key.partition(ADVANCED)[0]):
            return self._direction.admits("queries", key)
        self._direction.count("queries")
        return False

    def _by_number(self, key: str, query: zenoh.Query) -> bool:
        """Whether a query asks by numbers for what is not numbered here: it has been dropped on purpose."""
        subject, advanced, _ = key.partition(ADVANCED)
        return bool(advanced) and not self._numbered(subject) and query.parameters.get(_NUMBERS) is not None

    def _ask(self, query: zenoh.Query, options: QueryOptions, behind: int) -> None:
        self._asked_behind.await_gone(behind)
        self.crossed += 1
        handler = zenoh.handlers.Callback(partial(self._reply, query), partial(self._finish, query), indirect=False)
        # Whether replies on other keys are accepted is among the parameters, in their place.
        try:
            self._far.get(
                query.selector,
                handler,
                target=options.target,
                timeout=options.timeout,
                priority=options.priority,
                congestion_control=options.congestion_control,
                express=options.express,
                consolidation=zenoh.ConsolidationMode.NONE,
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
        sample, numbered = reply.ok, True
        if sample is not None:
            key = str(sample.key_expr)
            if not self._direction.admits("replies", key):
                return
            numbered = sample.source_info is None or self._numbered(key)
            if not numbered and sample.timestamp is None:
                return
        behind = self._answered_behind.newest
        self._executor.await_room(TUNING.reply_waits)  # as a router holds up who answers
        if not self._executor.offer(partial(self._answer, query, reply, behind, numbered=numbered)):
            log.warning("a reply is lost: more come than the application takes")

    def _finish(self, query: zenoh.Query) -> None:
        self._executor.insist(partial(self._end, query, self._answered_behind.newest))

    def _end(self, query: zenoh.Query, behind: int = 0) -> None:
        self._answered_behind.await_gone(behind)
        # A get that fails ends its query twice: by its error, and when Zenoh gives the handler up.
        if self._pending.pop(id(query), None) is not None:
            query.drop()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs

    def _answer(self, query: zenoh.Query, reply: zenoh.Reply, behind: int, *, numbered: bool) -> None:
        self._answered_behind.await_gone(behind)
        sample, error = reply.ok, reply.err
        if sample is not None:
            attachment = self._near.attachment_of(sample) if numbered else sample.attachment
            _give(query, sample, attachment)
        elif error is not None:
            query.reply_err(error.payload, encoding=error.encoding)


def _give(query: zenoh.Query, sample: zenoh.Sample, attachment: zenoh.ZBytes | bytes | None) -> None:
    if sample.kind == zenoh.SampleKind.DELETE:
        query.reply_del(sample.key_expr, express=sample.express, attachment=attachment, timestamp=sample.timestamp)
        return
    query.reply(
        sample.key_expr,
        sample.payload,
        encoding=sample.encoding,
        express=sample.express,
        attachment=attachment,
        timestamp=sample.timestamp,
    )
