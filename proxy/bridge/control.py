"""What an operator on this robot can ask and tell the daemon. Served on the app side only."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh
from pydantic_core import to_json

from proxy.bridge import keys
from proxy.bridge.declaration import Declaration
from proxy.bridge.questions import refuse, serve
from proxy.bridge.serial_executor import SerialExecutor
from proxy.core.model.mode import Mode
from proxy.errors import ProxyError
from proxy.profiling.profile import Profile
from proxy.profiling.profiler import Told
from proxy.profiling.request import END, ProfileError, Request, read

LIVE = b"live"
"""Asks for that part of the status which `sendworthy top` shows."""


def in_json(data: dict[str, Any]) -> bytes:
    """Return data as JSON: in a fifth of the time that `json` takes, but where a text is none, such as some paths."""
    try:
        return to_json(data, inf_nan_mode="constants")
    except ValueError:
        return json.dumps(data).encode()


class Control:
    """Answers `@sendworthy/<robot>/status` with JSON, takes a mode on `…/mode`, is profiled on `…/profile`.

    On `…/why` it tells the last decisions, on `…/specs` the files of the specs in force. `on_loop` runs a function on
    the loop's thread, where all other functions are called. Who asks for the status with the payload `live` hears less
    of each stream; who asks to be profiled with the payload `end` ends the profile that is being taken, and has it.
    """

    def __init__(
        self,
        *,
        app: zenoh.Session,
        robot: str,
        executor: SerialExecutor,
        on_loop: Callable[[Callable[[], None]], None],
        status: Callable[[], dict[str, Any]],
        live: Callable[[], dict[str, Any]],
        why: Callable[[bytes], dict[str, Any]],
        switch: Callable[[Mode], None],
        profile: Callable[[Request, Told], None],
        end_profile: Callable[[Told], None],
        specs: Callable[[], dict[str, Any]],
    ) -> None:
        self._executor = executor
        self._on_loop = on_loop
        self._status = status
        self._live = live
        self._why = why
        self._switch = switch
        self._profile = profile
        self._end_profile = end_profile
        self._specs = specs
        self._queryables: list[Declaration] = [
            self._declare(app, keys.status(robot), self._answer_status),
            self._declare(app, keys.why(robot), self._answer_why),
            self._declare(app, keys.mode(robot), self._answer_mode),
            self._declare(app, keys.profile(robot), self._answer_profile),
            self._declare(app, keys.specs(robot), self._answer_specs),
        ]

    def close(self) -> None:
        """Answer nothing more."""
        for queryable in self._queryables:
            queryable.undeclare()

    def _declare(self, app: zenoh.Session, key: str, answer: Callable[[str, zenoh.Query], None]) -> Declaration:
        return serve(app, key, partial(answer, key), executor=self._executor, on_loop=self._on_loop)

    def _answer_status(self, key: str, query: zenoh.Query) -> None:
        told = self._live() if bytes(query.payload or b"") == LIVE else self._status()
        self._reply(key, query, in_json(told), zenoh.Encoding.APPLICATION_JSON)

    def _answer_why(self, key: str, query: zenoh.Query) -> None:
        try:
            answer = self._why(bytes(query.payload or b""))
        except ProxyError as error:
            self._executor.insist(partial(refuse, query, str(error)))
            return
        self._reply(key, query, in_json(answer), zenoh.Encoding.APPLICATION_JSON)

    def _answer_mode(self, key: str, query: zenoh.Query) -> None:
        try:
            mode = Mode.read(bytes(query.payload or b""))
        except ValueError as error:
            self._executor.insist(partial(refuse, query, str(error)))
            return
        self._switch(mode)
        self._reply(key, query, mode.value, zenoh.Encoding.TEXT_PLAIN)

    def _answer_profile(self, key: str, query: zenoh.Query) -> None:
        """Answer when the profile has been taken, with JSON, or has failed."""

        def tell(profile: Profile) -> None:
            _tell(query, key, json.dumps(profile.write()), zenoh.Encoding.APPLICATION_JSON)

        def told(became: Profile | ProfileError) -> None:
            self._executor.insist(
                partial(tell, became) if isinstance(became, Profile) else partial(refuse, query, str(became))
            )

        payload = bytes(query.payload or b"")
        try:
            if payload == END:
                self._end_profile(told)
            else:
                self._profile(read(payload), told)
        except ProxyError as error:
            self._executor.insist(partial(refuse, query, str(error)))

    def _answer_specs(self, key: str, query: zenoh.Query) -> None:
        self._reply(key, query, json.dumps(self._specs()), zenoh.Encoding.APPLICATION_JSON)

    def _reply(self, key: str, query: zenoh.Query, payload: bytes | str, encoding: zenoh.Encoding) -> None:
        # Not on the loop's thread: an asker that does not read must not hold up decisions.
        self._executor.insist(partial(_tell, query, key, payload, encoding))


def _tell(query: zenoh.Query, key: str, payload: bytes | str, encoding: zenoh.Encoding) -> None:
    with query:
        query.reply(key, payload, encoding=encoding)
