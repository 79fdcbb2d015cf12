"""What an operator on this robot can tell the daemon of recording. Served on the app side only."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from proxy.bridge import keys
from proxy.bridge.questions import refuse, serve
from proxy.bridge.serial_executor import SerialExecutor
from proxy.errors import ProxyError
from proxy.recording.errors import RecordingError
from proxy.recording.recording import Recording
from proxy.recording.tuning import TUNING


class RecordingControl:
    """Answers `@sendworthy/<robot>/record` with what the daemon records, as JSON, after it did as it was told.

    That is {"record": "start"}, with "payloads": true if these are wanted, {"record": "stop"}, or nothing. `on_loop`
    runs a function on the loop's thread.
    """

    def __init__(
        self,
        app: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        on_loop: Callable[[Callable[[], None]], None],
        recording: Recording,
    ) -> None:
        self._key = keys.record(robot)
        self._executor = executor
        self._on_loop = on_loop
        self._recording = recording
        self._queryable = serve(app, self._key, self._answer, executor=executor, on_loop=on_loop)

    def close(self) -> None:
        """Answer nothing more."""
        self._queryable.undeclare()

    def _answer(self, query: zenoh.Query) -> None:
        try:
            order, payloads = _read(bytes(query.payload or b""))
            if order == "start":
                self._recording.start(payloads=payloads)
            elif order == "stop":
                self._recording.stop()
        except ProxyError as error:
            self._executor.insist(partial(refuse, query, str(error)))
            return
        self._executor.insist(partial(self._tell, query, order))

    def _tell(self, query: zenoh.Query, order: str) -> None:
        if order == "stop":
            self._recording.done(TUNING.patience)
        else:
            self._recording.begun(TUNING.patience)
        self._on_loop(lambda: self._executor.insist(partial(_reply, query, self._key, self._recording.describe())))


def _read(raw: bytes) -> tuple[str, bool]:
    """Return the order, or nothing, and whether payloads are wanted. Raises RecordingError."""
    try:
        told = json.loads(raw or b"{}")
        order, payloads = told.get("record", ""), told.get("payloads", False)
    except (ValueError, AttributeError, RecursionError):
        order, payloads = None, False
    if order not in ("", "start", "stop") or not isinstance(payloads, bool):
        raise RecordingError('recording is ordered with {"record": "start", "payloads": false} or {"record": "stop"}')
    return order, payloads


def _reply(query: zenoh.Query, key: str, told: dict[str, Any]) -> None:
    with query:
        query.reply(key, json.dumps(told), encoding=zenoh.Encoding.APPLICATION_JSON)
