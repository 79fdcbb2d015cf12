"""Serves the metrics over HTTP, and bears with whatever connects: what is no request is answered with an error, or not.

A few threads accept and serve one connection each, so no more than these are ever open. Who does not ask, or does not
read the answer, in time is cut off. While nobody connects no thread wakes.
"""

import io
import logging
import socket
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from typing import Any

from proxy import clock
from proxy.errors import MetricsError
from proxy.metrics.metric import Status

log = logging.getLogger(__name__)

PATH = "/metrics"
FORMAT = "text/plain; version=0.0.4; charset=utf-8"
"""The format that every Prometheus reads."""
THREADS = 2
"""So that one who dawdles does not keep the others waiting."""
PATIENCE = 2.0
"""A request must be there, and its answer be taken, within this time each [s]."""
LARGEST = 16_384
"""The largest head of a request [B]."""
BACKLOG = 8
"""Connections that may wait."""
PAUSE = 1.0
"""Time until the next try where the system has no room for a connection [s]."""


class MetricsServer:
    """Serves what `read` returns on `listen`, "HOST:PORT". Raises MetricsError if that cannot be had."""

    def __init__(self, listen: str, read: Callable[[], Status]) -> None:
        from proxy.metrics.exposition import Exposition  # noqa: PLC0415 - an extra

        self.text: Callable[[], bytes] = Exposition(read).text
        """Returns all metrics as they are now. Raises TimeoutError if the daemon is too busy."""
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
            connection.settimeout(PATIENCE)
            Answer(connection, address, self, head)
        except OSError as error:
            log.debug("metrics: %s: %s", address, error)
        except Exception:
            log.exception("metrics: %s was not answered", address)


class Answer(BaseHTTPRequestHandler):
    """Answers one request, whose `head` is there, on one connection."""

    timeout = PATIENCE

    def __init__(self, connection: socket.socket, address: Any, server: MetricsServer, head: bytes) -> None:
        self._metrics = server
        self._head = head
        super().__init__(connection, address, server)  # type: ignore[arg-type] # it only keeps the server

    def setup(self) -> None:
        """Read from what is there, and from nothing else."""
        super().setup()
        self.rfile.close()
        self.rfile = io.BufferedReader(io.BytesIO(self._head))

    def do_GET(self) -> None:
        """Answer with the metrics."""
        if self.path.partition("?")[0] != PATH:
            self.send_error(HTTPStatus.NOT_FOUND, f"The metrics are at {PATH}")
            return
        try:
            text = self._metrics.text()
        except TimeoutError:
            self.send_error(HTTPStatus.SERVICE_UNAVAILABLE, "The daemon is busy")
        else:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", FORMAT)
            self.send_header("Content-Length", str(len(text)))
            self.end_headers()
            self.wfile.write(text)

    def version_string(self) -> str:
        """Tell nobody which Python this is."""
        return "sendworthy"

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the name is that of its base
        """Log what was asked, for who looks for it."""
        log.debug(f"metrics: {self.client_address}: {format}", *args)  # noqa: G004 - the format is the message


def _head(connection: socket.socket) -> bytes:
    """Return what is sent up to an empty line, or up to where it is too much. Raises OSError when it is not in time."""
    head, until = b"", clock.monotonic() + PATIENCE
    while b"\r\n\r\n" not in head and b"\n\n" not in head and len(head) < LARGEST:
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
