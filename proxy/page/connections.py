"""Connections to the page's server: there are places for so many, which those that ask nothing do not keep."""

import asyncio
import socket

from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

from proxy.page.tuning import TUNING


class Connection(H11Protocol):
    """Is closed when no whole head of a request comes in time: the first one, or the next one after an answer.

    uvicorn waits for the first one for ever, and for a next one of which a byte has come. Nor does a browser keep its
    place that is gone without a word, as a tablet is whose battery is empty: the kernel would try for 15 minutes.
    """

    _due: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(transport)
        place: socket.socket = transport.get_extra_info("socket")
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux has it
            place.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(TUNING.silent * 1e3))
        self._wait()

    def on_response_complete(self) -> None:
        """Wait for the next request, which may have come already."""
        self._wait()
        super().on_response_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        if self._due is not None:
            self._due.cancel()
        super().connection_lost(exc)

    def _wait(self) -> None:
        if self._due is not None:
            self._due.cancel()
        self._due = self.loop.call_later(TUNING.head, self._late, self.cycle)

    def _late(self, last: RequestResponseCycle | None) -> None:
        """Close, if no request came behind the last one."""
        if self.cycle is last:
            self.transport.close()
