"""Zenoh nodes for tests: plain applications and endpoints nobody else uses."""

import itertools
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
import zenoh

from tests.ports import free_port
from tests.waiting import wait_until

STEADFAST = {"lease": 600_000, "queue": {"congestion_control": {"block": {"wait_before_close": 600_000_000}}}}
"""What links send: nobody gives one up while it stands still, as long as any test waits. It is the other end that is
told the lease."""


def free_endpoint() -> str:
    """A TCP endpoint on loopback that was free a moment ago."""
    return f"tcp/127.0.0.1:{free_port()}"


def plain_session(
    mode: str,
    *,
    listen: tuple[str, ...] = (),
    connect: tuple[str, ...] = (),
    stamps: bool = False,
    gossip: bool = False,
    retry: dict[str, int] | None = None,
    steadfast: bool = False,
) -> zenoh.Session:
    """An unmodified Zenoh node that knows nothing of Sendworthy and dials only what it is told.

    Nobody takes a `steadfast` one for lost that is silent for less than ten minutes.
    """
    again = {"retry": retry} if retry else {}
    options = {
        "mode": mode,
        "listen": {"endpoints": list(listen)},
        "connect": {"endpoints": list(connect), "timeout_ms": 5000, "exit_on_failure": False} | again,
        "timestamping": {"enabled": stamps},
        "transport": {"link": {"tx": STEADFAST if steadfast else {}}},
        "scouting": {
            "delay": 0,
            "multicast": {"enabled": False},
            "gossip": {} if gossip else {"autoconnect": {"peer": []}},
        },
    }
    return zenoh.open(zenoh.Config.from_json5(json.dumps(options)))


def free_group() -> str:
    """A multicast group for scouting that nobody else uses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return f"224.0.0.224:{probe.getsockname()[1]}"


def scouting(group: str, listen: str) -> zenoh.Session:
    """A peer in Zenoh's default configuration, but for the group and where it listens."""
    config = zenoh.Config()
    config.insert_json5("scouting/multicast/address", json.dumps(group))
    config.insert_json5("listen/endpoints", json.dumps([listen]))
    return zenoh.open(config)


def outside() -> str:
    """An address of this host that others can reach."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.77", 9))  # sends nothing
        except OSError:
            pytest.skip("this host has no network")
        return str(probe.getsockname()[0])


class Heard:
    """What a subscriber received, in order."""

    def __init__(self, session: zenoh.Session, expression: str) -> None:
        self._lock = threading.Lock()
        self._samples: list[zenoh.Sample] = []
        handler = zenoh.handlers.Callback(self._take, indirect=False)
        self.subscriber: Any = session.declare_subscriber(expression, handler)

    def _take(self, sample: zenoh.Sample) -> None:
        with self._lock:
            self._samples.append(sample)

    @property
    def samples(self) -> list[zenoh.Sample]:
        with self._lock:
            return list(self._samples)

    @property
    def payloads(self) -> list[str]:
        return [sample.payload.to_string() for sample in self.samples]


def closing(stack: ExitStack, session: zenoh.Session) -> zenoh.Session:
    """Close `session` with `stack`."""
    stack.callback(session.close)
    return session


def pass_fence(declarer: zenoh.Session, *others: zenoh.Session) -> None:
    """Wait until all that `declarer` has declared is known to `others`: links keep the order."""
    key = f"@fence/{next(_fences)}"
    token = declarer.liveliness().declare_token(key)
    for other in others:
        wait_until(lambda other=other: list(other.liveliness().get(key, timeout=5.0)), what="a fence")
    token.undeclare()


_fences = itertools.count()


def wait_matching(session: zenoh.Session, key: str) -> None:
    """Wait until `session` knows of another's subscriber to `key`: before, what it publishes goes nowhere."""
    probe = session.declare_publisher(key, allowed_destination=zenoh.Locality.REMOTE)
    wait_until(lambda: probe.matching_status.matching, what=f"a subscriber to {key}")
    probe.undeclare()


def answers(session: zenoh.Session, selector: str, **options: Any) -> Iterator[str]:
    """The payloads of all replies, errors as "error: …"."""
    for reply in session.get(selector, timeout=30.0, **options):
        yield reply.ok.payload.to_string() if reply.ok else f"error: {reply.err.payload.to_string()}"
