"""What is asked of the daemon on this robot, by its operator most of the time: by any application, it may be."""

from collections.abc import Callable
from functools import partial

import zenoh

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration
from proxy.bridge.serial_executor import SerialExecutor


def serve(
    app: zenoh.Session,
    key: str,
    answer: Callable[[zenoh.Query], None],
    *,
    executor: SerialExecutor,
    on_loop: Callable[[Callable[[], None]], None],
) -> Declaration:
    """Have questions on a key answered on the loop's thread, by way of `on_loop`; one that is too large is refused."""

    def receive(query: zenoh.Query) -> None:
        if len(query.payload or b"") > BOUNDS.question_bytes:
            executor.insist(partial(refuse, query, f"a question has at most {BOUNDS.question_bytes} bytes"))
        else:
            on_loop(partial(answer, query))

    return app.declare_queryable(key, zenoh.handlers.Callback(receive, indirect=False), complete=True)


def refuse(query: zenoh.Query, message: str) -> None:
    """Answer why there is no answer."""
    with query:
        query.reply_err(message)
