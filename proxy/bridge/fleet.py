"""Orders for all robots: passed on from an operator at any of them, and obeyed where the configuration allows it.

On the app side `@sendworthy/<robot>/to-fleet/<order>` passes an order on; on the mesh each robot that obeys it serves
`@sendworthy/<robot>/fleet/<order>`. Answers are JSON. A robot with a token has each order proved: who gives one asks
all for `challenge` first, and what answers the challenges goes beside the order, as its attachment.

Two operators may give orders at once, at two robots that each pass on their own. Neither waits for the other: who
passes an order on refuses the same kind of order from others meanwhile, so both operators hear that not all obeyed.
"""

import json
import logging
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial

import zenoh

from proxy import clock
from proxy.bridge import keys
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING
from proxy.fleet_token import OrderGuard

log = logging.getLogger(__name__)

CHALLENGE = "challenge"
ORDERS = ("mode", "specs", CHALLENGE)
CROSSED = "an operator there gives an order at the same time, which is obeyed in its place: agree, and give one again"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an order at one robot: what it says, or what is wrong, a line each."""

    robot: str
    obeyed: bool
    said: tuple[str, ...]


Obey = Callable[[bytes], Outcome]
Refuse = Callable[[float, str, str], object]


@dataclass(frozen=True, slots=True)
class Order:
    """What is ordered, and the proofs that came with it, if any."""

    payload: bytes
    proofs: bytes | None


class Fleet:
    """Obeys the orders in `obeyed` and passes on all.

    `members` tells the robots that are on the mesh by their own names, which several may share. Orders are obeyed on
    the thread of `executor`, and passed on on that of `passing`. With a `guard` an order needs proof; `refuse` gets the
    time [s], our name and the kind of what has none.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        mesh: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        passing: SerialExecutor,
        obeyed: Mapping[str, Obey],
        members: Callable[[], Iterable[str]],
        guard: OrderGuard | None = None,
        refuse: Refuse = lambda *_: None,
    ) -> None:
        self._mesh = mesh
        self._robot = robot
        self._obeying = threading.Lock()
        self._passed = ""
        """The order that is passed on at the moment, if any."""
        self._guard = guard
        self._refuse = refuse
        self._obeyed: dict[str, Obey] = dict(obeyed)
        if guard is not None:
            self._obeyed[CHALLENGE] = partial(self._challenge, guard)
        self._members = members
        self._queryables: list[Declaration] = [
            *(
                self._declare(mesh, keys.fleet(robot, order), partial(self._answer, order), executor)
                for order in self._obeyed
            ),
            *(
                self._declare(app, keys.to_fleet(robot, order), partial(self._pass_on, order), passing)
                for order in ORDERS
            ),
        ]

    def close(self) -> None:
        """Obey and pass on nothing more."""
        for queryable in self._queryables:
            queryable.undeclare()

    def _declare(
        self, session: zenoh.Session, key: str, answer: Callable[[Order], list[Outcome]], executor: SerialExecutor
    ) -> Declaration:
        def receive(query: zenoh.Query) -> None:
            if not executor.offer(partial(_reply, query, key, answer)):
                with query:
                    query.reply_err("too many orders at a time")

        handler = zenoh.handlers.Callback(receive, indirect=False)
        return session.declare_queryable(key, handler, complete=True, allowed_origin=zenoh.Locality.REMOTE)

    def _answer(self, name: str, order: Order) -> list[Outcome]:
        """Obey an order of another robot's operator, unless an operator here gives one of its kind."""
        with self._obeying:
            if name == self._passed != CHALLENGE:
                return [Outcome(self._robot, obeyed=False, said=(CROSSED,))]
            return [self._obey(name, order)]

    def _pass_on(self, name: str, order: Order) -> list[Outcome]:
        """Give the order to all others, then obey it: a change here may cut the link by which it goes."""
        with self._obeying:
            self._passed = name
        try:
            return self._passed_on(name, order)
        finally:
            self._passed = ""

    def _passed_on(self, name: str, order: Order) -> list[Outcome]:
        expected = Counter(self._members())
        outcomes = list(self._answered(expected, self._asked(name, order, expected)))
        silent = expected - Counter(outcome.robot for outcome in outcomes)
        outcomes += (Outcome(robot, obeyed=False, said=(_SILENT.format(name),)) for robot in silent.elements())
        with self._obeying:
            outcomes.append(self._own(name, order))
        return sorted(outcomes, key=lambda outcome: outcome.robot)

    def _answered(self, expected: Counter[str], outcomes: Iterable[Outcome]) -> Iterator[Outcome]:
        """Yield one outcome of each name, but as many as there are robots of that name."""
        heard: Counter[str] = Counter()
        for outcome in outcomes:
            heard[outcome.robot] += 1
            if heard[outcome.robot] <= max(expected[outcome.robot], outcome.robot != self._robot):
                yield outcome

    def _own(self, name: str, order: Order) -> Outcome:
        if name in self._obeyed:
            return self._obey(name, order)
        return Outcome(self._robot, obeyed=False, said=(f"fleet.{name} is false in its configuration",))

    def _obey(self, name: str, order: Order) -> Outcome:
        """Obey, if the order is proved where it has to be."""
        if self._guard is not None and name != CHALLENGE:
            now = clock.monotonic()
            if wrong := self._guard.objection(now, name, order.payload, order.proofs):
                self._refuse(now, self._robot, "order:unproved")
                log.warning("an order is refused (%s): %s", name, wrong, extra={"reason": "order:unproved"})
                return Outcome(self._robot, obeyed=False, said=(wrong,))
        return self._obeyed[name](order.payload)

    def _challenge(self, guard: OrderGuard, _: bytes) -> Outcome:
        return Outcome(self._robot, obeyed=True, said=(guard.challenge(clock.monotonic()).hex(),))

    def _asked(self, name: str, order: Order, expected: Counter[str]) -> Iterable[Outcome]:
        """Yield what robots answer. Those of each name have room of their own, those that nobody knows share some."""
        replies = self._mesh.get(
            keys.fleet("*", name),
            payload=order.payload,
            attachment=order.proofs,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=TUNING.order_wait,
            priority=zenoh.Priority.DATA_LOW,
            allowed_destination=zenoh.Locality.REMOTE,
        )
        taken: Counter[str] = Counter()
        for reply in replies:
            if reply.ok is None:
                continue
            size, robot = len(reply.ok.payload), keys.robot_of(str(reply.ok.key_expr))
            whose = robot if robot in expected else ""
            room = BOUNDS.answer_bytes * max(1, expected[whose])
            if taken[whose] + size <= room and taken.total() + size <= BOUNDS.answers_bytes:
                taken[whose] += size
                yield from _of_itself(reply.ok)


_SILENT = "no answer: it is out of reach, or fleet.{} is false in its configuration"


def _reply(query: zenoh.Query, key: str, answer: Callable[[Order], list[Outcome]]) -> None:
    with query:
        payload, proofs = query.payload, query.attachment
        if payload is None or len(payload) > BOUNDS.order_bytes or len(proofs or b"") > BOUNDS.proof_bytes:
            query.reply_err("the order is empty or too large")
            return
        order = Order(payload.to_bytes(), None if proofs is None else proofs.to_bytes())
        outcomes = [asdict(outcome) for outcome in answer(order)]
        query.reply(key, json.dumps(outcomes), encoding=zenoh.Encoding.APPLICATION_JSON)


def _of_itself(answer: zenoh.Sample) -> Iterable[Outcome]:
    """Return what a robot says became of an order at itself: access control keeps it to keys with its own name."""
    robot = keys.robot_of(str(answer.key_expr))
    return (outcome for outcome in read_outcomes(answer.payload.to_bytes()) if outcome.robot == robot)


def challenges(outcomes: Iterable[Outcome]) -> dict[str, bytes]:
    """Return the challenges that robots gave, by robot; what is none is left out."""
    found: dict[str, bytes] = {}
    for outcome in outcomes:
        if outcome.obeyed and outcome.said:
            with suppress(ValueError):
                found[outcome.robot] = bytes.fromhex(outcome.said[0])
    return found


def read_outcomes(raw: bytes) -> list[Outcome]:
    """Return what robots answered; nothing when it is no answer."""
    try:
        return [
            Outcome(str(each["robot"]), bool(each["obeyed"]), tuple(map(str, each["said"]))) for each in json.loads(raw)
        ]
    except (ValueError, TypeError, KeyError, RecursionError):
        return []
