"""The applications of the benchmark: plain Zenoh programs that do what a line of JSON says.

`python -m studies.benchmarks.bridge.application publish|listen --mode MODE [--listen E] [--connect E]`

    publish: {"key", "size", "seconds", "rate", "block"} → {"sent", "seconds"}; rate 0: as fast as it goes
    listen:  {} → {"count", "seconds", "latencies"}, what came since the last time; latencies [s] of paced samples
"""

import argparse
import json
import struct
import sys
import threading
import time
from collections.abc import Mapping
from typing import Any

import zenoh

HEAD = struct.Struct("<dd")
"""When the sample was published, on the clock that all processes of the machine share, and whether that counts."""
EVERY = 64
"""A listener that counts reads the clock for one of so many samples."""
AT_ONCE = 32
"""Samples between two looks at the clock when publishing as fast as it goes."""


def main() -> None:
    """Open a session, say so, and do what the lines of standard input say."""
    parser = argparse.ArgumentParser()
    parser.add_argument("role", choices=("publish", "listen"))
    parser.add_argument("--mode", default="client")
    parser.add_argument("--listen", action="append", default=[])
    parser.add_argument("--connect", action="append", default=[])
    parser.add_argument("--key", default="bench/**", help="what to listen to")
    parser.add_argument("--piece", type=int, default=65535, help="largest piece on a link [B]")
    options = parser.parse_args()
    with zenoh.open(_config(options)) as session:
        if options.role == "publish":
            _serve(lambda order: publish(session, **order))
        else:
            listener = Listener(session, options.key)
            _serve(lambda _: listener.report())


def publish(
    session: zenoh.Session, *, key: str, size: int, seconds: float, rate: float, block: bool
) -> dict[str, float]:
    """Publish samples of `size` [B] for `seconds` [s]; `rate` [1/s], 0 as fast as it goes. Return what was sent."""
    control = zenoh.CongestionControl.BLOCK if block else zenoh.CongestionControl.DROP
    publisher = session.declare_publisher(key, congestion_control=control)
    filling = bytes(max(0, size - HEAD.size))
    began = due = time.monotonic()
    sent = 0
    while (now := time.monotonic()) - began < seconds:
        payload = HEAD.pack(now, float(rate > 0.0)) + filling
        for _ in range(1 if rate else AT_ONCE):
            publisher.put(payload)
            sent += 1
        if rate:
            due += 1.0 / rate
            time.sleep(max(0.0, due - time.monotonic()))
    took = time.monotonic() - began
    publisher.undeclare()  # type: ignore[no-untyped-call] # an omission of Zenoh's stubs
    return {"sent": sent, "seconds": took}


class Listener:
    """Counts what arrives, with one look at the clock in `EVERY`; of paced samples it notes the latency."""

    def __init__(self, session: zenoh.Session, key: str) -> None:
        self._lock = threading.Lock()
        self._reset()
        handler = zenoh.handlers.Callback(self._take, indirect=False)
        self._subscriber = session.declare_subscriber(key, handler)

    def report(self) -> dict[str, Any]:
        """Return what came since the last time, when nothing comes any more."""
        count = -1
        while count != self._count:
            count = self._count
            time.sleep(0.25)
        with self._lock:
            report = {"count": self._count, "seconds": self._last - self._first, "latencies": self._latencies}
            self._reset()
        return report

    def _reset(self) -> None:
        self._count = 0
        self._first = self._last = 0.0
        self._latencies: list[float] = []

    def _take(self, sample: zenoh.Sample) -> None:
        self._count += 1
        if self._latencies or self._count % EVERY == 1:
            self._look(sample, time.monotonic())

    def _look(self, sample: zenoh.Sample, now: float) -> None:
        with self._lock:
            self._first = self._first or now
            self._last = now
            published, paced = HEAD.unpack(bytes(sample.payload)[: HEAD.size])
            if paced:
                self._latencies.append(now - published)


def _serve(act: Any) -> None:
    print(json.dumps({"ready": True}), flush=True)
    for line in sys.stdin:
        print(json.dumps(act(json.loads(line))), flush=True)


def _config(options: argparse.Namespace) -> zenoh.Config:
    settings: Mapping[str, Any] = {
        "mode": options.mode,
        "listen": {"endpoints": options.listen},
        "connect": {"endpoints": options.connect, "timeout_ms": 10_000},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {"shared_memory": {"enabled": False}, "link": {"tx": {"batch_size": options.piece}}},
    }
    return zenoh.Config.from_json5(json.dumps(settings))


if __name__ == "__main__":
    main()
