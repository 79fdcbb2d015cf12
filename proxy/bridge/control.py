"""What an operator on this robot can ask and tell the daemon. Served on the app side only."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from proxy.bridge import keys
from proxy.bridge.declaration import Declaration
from proxy.bridge.serial_executor import SerialExecutor
from proxy.core.model.mode import Mode


class Control:
    """Answers `@sendworthy/<robot>/status` with JSON and takes a mode on `@sendworthy/<robot>/mode`.

    `on_loop` runs a function on the loop's thread, where `status` and `switch` are called.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        on_loop: Callable[[Callable[[], None]], None],
        status: Callable[[], dict[str, Any]],
        switch: Callable[[Mode], None],
    ) -> None:
        self._executor = executor
        self._on_loop = on_loop
        self._status = status
        self._switch = switch
        self._queryables: list[Declaration] = [
            self._declare(app, keys.status(robot), self._answer_status),
            self._declare(app, keys.mode(robot), self._answer_mode),
        ]

    def close(self) -> None:
        """Answer nothing more."""
        for queryable in self._queryables:
            queryable.undeclare()

    def _declare(self, app: zenoh.Session, key: str, answer: Callable[[str, zenoh.Query], None]) -> Declaration:
        def receive(query: zenoh.Query) -> None:
            self._on_loop(partial(answer, key, query))

        return app.declare_queryable(key, zenoh.handlers.Callback(receive, indirect=False), complete=True)

    def _answer_status(self, key: str, query: zenoh.Query) -> None:
        self._reply(key, query, json.dumps(self._status()), zenoh.Encoding.APPLICATION_JSON)

    def _answer_mode(self, key: str, query: zenoh.Query) -> None:
        try:
            mode = Mode.read(bytes(query.payload or b""))
        except ValueError as error:
            self._executor.insist(partial(_refuse, query, str(error)))
            return
        self._switch(mode)
        self._reply(key, query, mode.value, zenoh.Encoding.TEXT_PLAIN)

    def _reply(self, key: str, query: zenoh.Query, payload: str, encoding: zenoh.Encoding) -> None:
        # Not on the loop's thread: an asker that does not read must not hold up decisions.
        self._executor.insist(partial(_tell, query, key, payload, encoding))


def _tell(query: zenoh.Query, key: str, payload: str, encoding: zenoh.Encoding) -> None:
    with query:
        query.reply(key, payload, encoding=encoding)


def _refuse(query: zenoh.Query, payload: str) -> None:
    with query:
        query.reply_err(payload)
