"""What is between the robots: links that carry every byte at once, and note what crossed and when.

A port for each pair of robots, as in the demo, but without a rate. A link's batches are read one by one; when each
arrived is the kernel's word, not ours: the time at which it took the last byte in (SO_TIMESTAMPNS), some 40 µs after
the robot began to write, however late this process is woken. Only when it is so late that the kernel joins two
writes, the first counts as late as the second.
"""

import argparse
import json
import socket
import struct
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from studies.benchmarks.traffic.payload import HEAD, MARK, Label, read
from studies.demo import cue

BUFFER = 65536
"""Of each socket, as daemons have them [B]."""
RETRY = 0.05
"""Time between attempts to reach a robot that does not listen yet [s]."""
_TIMESTAMPS = 35
"""SO_TIMESTAMPNS and SCM_TIMESTAMPNS of <asm-generic/socket.h>."""
_TIME = struct.Struct("@qq")
_FRAME, _FRAGMENT = 0x05, 0x06
"""Kinds of batches that hold messages; the others open links and keep them alive."""

Crossing = list[Any]
"""When a batch crossed [s, monotonic], its source and sink, its bytes, what of these are messages of no sample (what
daemons tell each other), and the samples of which it is the beginning."""


class Way:
    """One direction of a link: says what each batch holds."""

    def __init__(self, source: str, sink: str) -> None:
        self._ends = (source, sink)
        self._left = 0
        """What is still to come of a payload that began in an earlier batch [B]."""

    def crossing(self, t: float, batch: bytes) -> Crossing:
        """Return what a batch is; it begins with its length, two bytes."""
        labels, kind = _labels(batch), batch[2] & 0x1F
        mine = bool(labels)
        if kind == _FRAGMENT:
            mine |= self._left > 0
            after = labels[-1].size - (len(batch) - batch.rindex(MARK)) if labels else self._left - len(batch)
            self._left = max(0, after)
        told = 0 if mine or kind not in (_FRAME, _FRAGMENT) else len(batch)
        samples = [(*label.name, label.size) for label in labels]
        return [t, *self._ends, len(batch), told, samples]


def _labels(batch: bytes) -> list[Label]:
    found, at = [], batch.find(MARK)
    while 0 <= at <= len(batch) - HEAD:
        found.append(read(batch, at))
        at = batch.find(MARK, at + HEAD)
    return found


class Link:
    """Carries between who dialled and a robot, until either hangs up."""

    def __init__(self, near: socket.socket, far: socket.socket, ends: tuple[str, str], crossed: list[Crossing]) -> None:
        self._ends = near, far
        self._over = threading.Barrier(2)
        for number, way in ((0, Way(*ends)), (1, Way(*ends[::-1]))):
            threading.Thread(target=self._carry, args=(number, way, crossed), daemon=True).start()

    def _carry(self, number: int, way: Way, crossed: list[Crossing]) -> None:
        source, sink = self._ends[number], self._ends[1 - number]
        _prepare(source)
        with suppress(OSError):
            while (received := _batch(source)) is not None:
                sink.sendall(received[1])
                crossed.append(way.crossing(*received))
        for end in self._ends:
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
        self._over.wait()
        source.close()


def _batch(source: socket.socket) -> tuple[float, bytes] | None:
    """Return the next batch with its length, and when it arrived [s, monotonic]; None at the end."""
    length, _, _, _ = source.recvmsg(2, 64, socket.MSG_WAITALL)
    if len(length) < 2:
        return None
    size = int.from_bytes(length, "little")
    body, said, _, _ = source.recvmsg(size, 64, socket.MSG_WAITALL)
    behind = time.clock_gettime(time.CLOCK_REALTIME) - time.monotonic()
    times = [_TIME.unpack(data) for _, kind, data in said if kind == _TIMESTAMPS]
    t = times[0][0] + times[0][1] / 1e9 - behind if times else time.monotonic()
    return (t, length + body) if len(body) == size else None


def _prepare(sock: socket.socket) -> None:
    sock.setsockopt(socket.SOL_SOCKET, _TIMESTAMPS, 1)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def _small(sock: socket.socket) -> None:
    for of in (socket.SO_RCVBUF, socket.SO_SNDBUF):
        sock.setsockopt(socket.SOL_SOCKET, of, BUFFER)


def listen(dialer: str, target: str, port: int, crossed: list[Crossing], stop: threading.Event) -> int:
    """Open the port at which `dialer` reaches `target`, which listens at `port`; return it."""
    listener = socket.create_server(("127.0.0.1", 0))
    _small(listener)

    def accept() -> None:
        with listener:
            while not stop.is_set():
                near, _ = listener.accept()
                far = _dial(port, stop)
                Link(near, far, (dialer, target), crossed)

    threading.Thread(target=accept, daemon=True).start()
    return int(listener.getsockname()[1])


def _dial(port: int, stop: threading.Event) -> socket.socket:
    while True:
        far = socket.socket()
        _small(far)
        if far.connect_ex(("127.0.0.1", port)) == 0:
            return far
        far.close()
        stop.wait(RETRY)


def main() -> None:
    """Open one port for each pair, say which, and carry until told to stop; then write what crossed, as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pair", action="append", default=[], help="DIALER,TARGET,PORT of the target on localhost")
    parser.add_argument("--log", type=Path, required=True, help="file for what crossed")
    options = parser.parse_args()
    stop = cue.stop_on_signal()
    crossed: list[Crossing] = []
    pairs = [pair.split(",") for pair in options.pair]
    cue.ready(ports=[listen(dialer, target, int(port), crossed, stop) for dialer, target, port in pairs])
    stop.wait()
    options.log.write_text(json.dumps(list(crossed)))


if __name__ == "__main__":
    main()
