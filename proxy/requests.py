"""What signals ask of the daemon, and of commands that go on until they are asked to end.

A handler that set an event would wait for ever where the signal came while its own thread had the event in hand.
"""

import select
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


class Requests:
    """Takes in signals from now on, until its context ends. On the main thread.

    The kernel gives a signal to any thread, also to one of Zenoh's. Python then runs a handler when its main thread
    wakes; but it writes the signal's number to a socket at once, which wakes it.

    Where a request to end is not taken up within so many seconds of `patience`, as a file is being read without end,
    the kernel ends the process. A request that comes just before such a read begins is heard with the next one only.
    """

    def __init__(self, patience: int = 0) -> None:
        self._patience = patience
        self._heard, self._told = socket.socketpair()
        self._told.setblocking(False)
        signal.set_wakeup_fd(self._told.fileno())
        for number in SIGNALS:
            signal.signal(number, self._hurry)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        signal.set_wakeup_fd(-1)
        if self._patience:
            self._patience = 0  # a handler may still be due
            signal.alarm(0)
        self._heard.close()
        self._told.close()

    def next(self, timeout: float, also: int = -1) -> str:
        """Wait for a signal, at most `timeout` [s], or until the file `also` has something to read.

        Returns the signal's name, nothing if there was none.
        """
        waiting = select.poll()
        for number in (self._heard.fileno(), also):
            if number >= 0:
                waiting.register(number, select.POLLIN)
        ready = {number for number, _ in waiting.poll(timeout * 1e3)}
        if self._heard.fileno() in ready and self._patience:
            signal.alarm(0)
        return signal.Signals(self._heard.recv(1)[0]).name if self._heard.fileno() in ready else ""

    def _hurry(self, number: int, _frame: object) -> None:
        """Its number is written already."""
        if self._patience and number != signal.SIGHUP:
            signal.alarm(self._patience)


@contextmanager
def asked_to_end() -> Iterator[Requests]:
    """Take in signals for a while; afterwards they do what they did before."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    try:
        with Requests() as asked:
            yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
