"""Orders for all robots: passed on from an operator at any of them, and obeyed where the configuration allows it.

On the app side `@sendworthy/<robot>/to-fleet/<order>` passes an order on; on the mesh each robot that obeys it serves
`@sendworthy/<robot>/fleet/<order>`. Answers are JSON.
"""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import partial

import zenoh

from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING

ORDERS = ("mode", "specs")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an order at one robot: what it says, or what is wrong, a line each."""

    robot: str
    obeyed: bool
    said: tuple[str, ...]


Obey = Callable[[bytes], Outcome]


class Fleet:
    """Obeys the orders in `obeyed` and passes on all. `members` tells the robots that are on the mesh."""

    def __init__(
        self,
        *,
        app: zenoh.Session,
        mesh: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        obeyed: Mapping[str, Obey],
        members: Callable[[], Iterable[str]],
    ) -> None:
        self._mesh = mesh
        self._robot = robot
        self._executor = executor
        self._obeyed = obeyed
        self._members = members
        self._queryables: list[Declaration] = [
            *(self._declare(mesh, keys.fleet(robot, order), partial(self._answer, order)) for order in obeyed),
            *(self._declare(app, keys.to_fleet(robot, order), partial(self._pass_on, order)) for order in ORDERS),
        ]

    def close(self) -> None:
        """Obey and pass on nothing more."""
        for queryable in self._queryables:
            queryable.undeclare()

    def _declare(self, session: zenoh.Session, key: str, answer: Callable[[bytes], list[Outcome]]) -> Declaration:
        def receive(query: zenoh.Query) -> None:
            if not self._executor.offer(partial(_reply, query, key, answer)):
                with query:
                    query.reply_err("too many orders at a time")

        handler = zenoh.handlers.Callback(receive, indirect=False)
        return session.declare_queryable(key, handler, complete=True, allowed_origin=zenoh.Locality.REMOTE)

    def _answer(self, order: str, payload: bytes) -> list[Outcome]:
        return [self._obeyed[order](payload)]

    def _pass_on(self, order: str, payload: bytes) -> list[Outcome]:
        """Give the order to all others, then obey it: a change here may cut the link by which it goes."""
        expected = set(self._members())
        outcomes = {outcome.robot: outcome for outcome in self._asked(order, payload)}
        silent = expected - outcomes.keys()
        outcomes |= {robot: Outcome(robot, obeyed=False, said=(_SILENT.format(order),)) for robot in silent}
        outcomes[self._robot] = self._own(order, payload)
        return [outcomes[robot] for robot in sorted(outcomes)]

    def _own(self, order: str, payload: bytes) -> Outcome:
        if order in self._obeyed:
            return self._obeyed[order](payload)
        return Outcome(self._robot, obeyed=False, said=(f"fleet.{order} is false in its configuration",))

    def _asked(self, order: str, payload: bytes) -> Iterable[Outcome]:
        replies = self._mesh.get(
            keys.fleet("*", order),
            payload=payload,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=TUNING.order_wait,
            priority=zenoh.Priority.DATA_LOW,
            allowed_destination=zenoh.Locality.REMOTE,
        )
        for reply in replies:
            if reply.ok is not None:
                yield from read_outcomes(reply.ok.payload.to_bytes())


_SILENT = "no answer: it is out of reach, or fleet.{} is false in its configuration"


def _reply(query: zenoh.Query, key: str, answer: Callable[[bytes], list[Outcome]]) -> None:
    with query:
        payload = query.payload
        if payload is None or len(payload) > BOUNDS.order_bytes:
            query.reply_err("the order is empty or too large")
            return
        outcomes = [asdict(outcome) for outcome in answer(payload.to_bytes())]
        query.reply(key, json.dumps(outcomes), encoding=zenoh.Encoding.APPLICATION_JSON)


def read_outcomes(raw: bytes) -> list[Outcome]:
    """Return what robots answered; nothing when it is no answer."""
    try:
        return [
            Outcome(str(each["robot"]), bool(each["obeyed"]), tuple(map(str, each["said"]))) for each in json.loads(raw)
        ]
    except (ValueError, TypeError, KeyError):
        return []
