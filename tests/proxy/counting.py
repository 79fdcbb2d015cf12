"""A relay between two Zenoh nodes that counts what it carries."""

import socket
import threading

from tests.ports import free_port


class Counting:
    """Passes one TCP connection on to `endpoint`; `carried` are the bytes that came back from there."""

    def __init__(self, endpoint):
        self._target = int(endpoint.rsplit(":", 1)[1])
        port = free_port()
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self.carried = 0
        self._server = socket.create_server(("127.0.0.1", port))
        self._ends = []

    def __enter__(self):
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_):
        for end in (self._server, *self._ends):
            end.close()

    def _accept(self):
        near, _ = self._server.accept()
        far = socket.create_connection(("127.0.0.1", self._target))
        self._ends += [near, far]
        threading.Thread(target=self._pump, args=(near, far, False), daemon=True).start()
        threading.Thread(target=self._pump, args=(far, near, True), daemon=True).start()

    def _pump(self, source, sink, counted):
        try:
            while data := source.recv(65536):
                self.carried += len(data) * counted
                sink.sendall(data)
        except OSError:
            return
        finally:
            sink.close()
