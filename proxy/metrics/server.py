"""Serves the metrics over HTTP, and bears with whatever connects: what is no request is answered with an error, or not.

A few threads accept and serve one connection each, so no more than these are ever open. Who does not ask, or does not
read the answer, in time is cut off. While nobody connects no thread wakes.
"""

import logging
import socket
import threading
from collections.abc import Callable
from typing import Any

from proxy import clock
from proxy.errors import MetricsError
from proxy.metrics.exposition import Exposition
from proxy.metrics.metric import Status
from proxy.metrics.request import LARGEST, answer, is_whole

log = logging.getLogger(__name__)

THREADS = 2
"""So that one who dawdles does not keep the others waiting."""
PATIENCE = 2.0
"""A request must be there, and its answer be taken, within this time each [s]."""
BACKLOG = 8
"""Connections that may wait."""
PAUSE = 1.0
"""Time until the next try where the system has no room for a connection [s]."""


class MetricsServer:
    """Serves what `read` returns on `listen`, "HOST:PORT". Raises MetricsError if that cannot be had."""

    def __init__(self, listen: str, read: Callable[[], Status]) -> None:
        self._text = Exposition(read).text
        self._socket = _listening(listen)
        self._closed = threading.Event()
        self._threads = [threading.Thread(target=self._serve, name="metrics", daemon=True) for _ in range(THREADS)]
        for thread in self._threads:
            thread.start()

    def close(self, timeout: float) -> None:
        """Serve nothing more; wait for each thread at most `timeout` [s]."""
        self._closed.set()
        try:
            self._socket.shutdown(socket.SHUT_RDWR)  # those that wait for a connection wake
        except OSError as error:
            log.debug("metrics: %s", error)
        self._socket.close()
        for thread in self._threads:
            thread.join(timeout)

    def _serve(self) -> None:
        while not self._closed.is_set():
            try:
                connection, address = self._socket.accept()
            except OSError as error:  # closed; or there are no file descriptors left, which passes
                if not self._closed.wait(PAUSE):
                    log.warning("metrics: cannot accept a connection: %s", error.strerror)
                continue
            with connection:
                self._answer(connection, address)

    def _answer(self, connection: socket.socket, address: Any) -> None:
        try:
            head = _head(connection)
            log.debug("metrics: %s asks %r", address, head[: head.find(b"\n")])
            told = answer(head, clock.wall(), self._text)
            connection.settimeout(PATIENCE)
            connection.sendall(told)
        except OSError as error:
            log.debug("metrics: %s: %s", address, error)
        except Exception:
            log.exception("metrics: %s was not answered", address)


def _head(connection: socket.socket) -> bytes:
    """Return what is sent up to an empty line, or up to where it is too much. Raises OSError when it is not in time."""
    head, until = b"", clock.monotonic() + PATIENCE
    while not is_whole(head) and len(head) < LARGEST:
        connection.settimeout(max(until - clock.monotonic(), 1e-3))
        part = connection.recv(LARGEST - len(head))
        if not part:
            break
        head += part
    return head


def _listening(listen: str) -> socket.socket:
    host, _, port = listen.rpartition(":")
    host = host.strip("[]")
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, int(port)), family=family, backlog=BACKLOG)
    except OSError as error:
        raise MetricsError(f"metrics.listen: nothing can listen on {listen}: {error.strerror}") from None
