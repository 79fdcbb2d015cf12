"""A local link that passes every byte on and shows it to a table.

`widening` and `source_info` say what it alters.
"""

import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from proxy.bridge.declarations.source_info import SourceInfoInsertion, new_mark
from proxy.bridge.declarations.table import DeclarationTable
from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.widening import InterestWidening


class DeclarationTap:
    """Listens on the socket `near`; whoever connects is connected with the socket `far`. One link at a time.

    The first `interests` of each link in one key of ours are widened. Replies with the `mark` get source info.
    """

    def __init__(self, near: Path, far: Path, table: DeclarationTable, interests: int = 0) -> None:
        self._far = far
        self._table = table
        self._interests = interests
        self.mark = new_mark()
        self.widened = threading.Event()
        """All of a link's interests have been."""
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(near))
        self._listener.listen()
        self._open: tuple[socket.socket, ...] = ()
        self._thread = threading.Thread(target=self._accept, name="tap", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Cut the link and take no other."""
        for link in (self._listener, *self._open):
            _cut(link)
        self._thread.join(1.0)
        self._listener.close()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:  # closed
                return
            with near, socket.socket(socket.AF_UNIX) as far:
                self._open = (near, far)
                with suppress(OSError):
                    far.connect(str(self._far))
                    self._carry(near, far)

    def _carry(self, near: socket.socket, far: socket.socket) -> None:
        self._table.reset()
        outward = threading.Thread(target=self._pass_outward, args=(near, far), name="tap out", daemon=True)
        outward.start()
        self._pass_on(far, near, lambda data: data, inward=True)
        outward.join()

    def _pass_outward(self, near: socket.socket, far: socket.socket) -> None:
        widening, insertion = InterestWidening(self._interests), SourceInfoInsertion(self.mark)

        def alter(data: bytes) -> bytes:
            data = widening.feed(data)
            if widening.done:
                self.widened.set()
            return insertion.feed(data)

        self._pass_on(near, far, alter, inward=False)

    def _pass_on(
        self, source: socket.socket, target: socket.socket, alter: Callable[[bytes], bytes], *, inward: bool
    ) -> None:
        try:
            while data := source.recv(TUNING.chunk):
                self._table.read(data, inward=inward)
                target.sendall(alter(data))
        except OSError:
            pass  # the link is gone, which the ends notice themselves
        finally:
            _cut(source)
            _cut(target)


def _cut(link: socket.socket) -> None:
    with suppress(OSError):
        link.shutdown(socket.SHUT_RDWR)
