"""A relay between two Zenoh nodes that counts what it carries, and can be cut."""

import socket
import threading
from contextlib import suppress

from tests.ports import free_port


class Counting:
    """Passes TCP connections on to `endpoint`, unless it is `cut`; `carried` are the bytes that came from there.

    A bytearray `taps` gets all that goes either way. Of what goes to `endpoint` some bytes are `replaced` by others.
    """

    def __init__(self, endpoint, *, cut=False, taps=None, replaced=()):
        self._taps = taps
        self._replaced = dict(replaced)
        self._target = int(endpoint.rsplit(":", 1)[1])
        port = free_port()
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self.carried = 0
        self._cut = cut
        self._server = socket.create_server(("127.0.0.1", port))
        self._ends, self._lost, self._halved = [], set(), set()

    def __enter__(self):
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.cut()
        with suppress(OSError):
            self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()

    def cut(self):
        """Carry nothing from now on."""
        self._cut = True
        ends, self._ends = self._ends, []
        for end in ends:
            _close(end)

    def lose(self):
        """Carry nothing from now on, which nobody is told: as a radio out of reach."""
        self._cut = True
        self._lost |= set(self._ends)

    def halve(self):
        """Let `endpoint` see the end of each connection; whoever dialled does not, for nothing comes any more."""
        near, far = self._ends[::2], self._ends[1::2]
        self._halved |= set(near)
        for end in far:
            end.shutdown(socket.SHUT_RDWR)

    def mend(self):
        """Carry again."""
        self._cut = False

    def _accept(self):
        while True:
            try:
                near, _ = self._server.accept()
            except OSError:
                return
            far = None if self._cut else self._reach()
            if far is None:
                near.close()
                continue
            self._ends += [near, far]
            threading.Thread(target=self._pump, args=(near, far, False), daemon=True).start()
            threading.Thread(target=self._pump, args=(far, near, True), daemon=True).start()

    def _reach(self):
        with suppress(OSError):  # nobody listens yet, or any more
            return socket.create_connection(("127.0.0.1", self._target))

    def _pump(self, source, sink, counted):
        with suppress(OSError):
            while data := source.recv(65536):
                if source not in self._lost:
                    for some, others in () if counted else self._replaced.items():
                        data = data.replace(some, others)
                    self.carried += len(data) * counted
                    if self._taps is not None:
                        self._taps += data
                    sink.sendall(data)
        if sink not in self._halved:
            _close(sink)


def _close(end):
    with suppress(OSError):
        end.shutdown(socket.SHUT_RDWR)
    end.close()
