"""Metrics of the other robots, and of what daemons tell each other."""

from collections.abc import Iterator
from functools import partial

from proxy.metrics.metric import Metric, Row, Status, by_name, each_of, entry, single

WAYS = "in", "out"


def _latencies(part: str, status: Status) -> Iterator[Row]:
    for peer in status["peers"]:
        for way in WAYS:
            if line := peer[f"latency_{way}"]:
                yield (peer["robot"], way), line[part]


def _losses(status: Status) -> Iterator[Row]:
    for peer in status["peers"]:
        for way in WAYS:
            if (loss := peer[f"loss_{way}"]) is not None:
                yield (peer["robot"], way), loss


def _of_peers(name: str, status: Status) -> Iterator[Row]:
    return each_of(("peers",), ("robot",), partial(entry, name))(status)


PEERS = (
    Metric("peers", "gauge", "Other robots that are here.", lambda status: [((), float(len(status["peers"])))]),
    Metric(
        "peer_takes_part",
        "gauge",
        "1 for a robot that this one plans with, 0 for one that it does not understand.",
        partial(_of_peers, "takes_part"),
        ("peer",),
    ),
    Metric(
        "peer_latency_seconds",
        "gauge",
        "What a sample takes from (in) and to (out) a robot, whatever its size.",
        partial(_latencies, "fixed"),
        ("peer", "direction"),
    ),
    Metric(
        "peer_latency_seconds_per_byte",
        "gauge",
        "What each byte of a sample adds to that.",
        partial(_latencies, "per_byte"),
        ("peer", "direction"),
    ),
    Metric(
        "peer_loss_ratio",
        "gauge",
        "What part of the samples is lost from (in) and to (out) a robot.",
        _losses,
        ("peer", "direction"),
    ),
    Metric(
        "peer_clock_ahead_seconds",
        "gauge",
        "By how much the wall clock of a robot is ahead of ours.",
        partial(_of_peers, "wall_ahead"),
        ("peer",),
    ),
    Metric(
        "peer_digest_age_seconds",
        "gauge",
        "How long ago a robot told what is new.",
        partial(_of_peers, "digest_age"),
        ("peer",),
    ),
    Metric(
        "peer_samples_received",
        "counter",
        "Samples of a robot that came.",
        partial(_of_peers, "samples"),
        ("peer",),
    ),
    Metric(
        "digest_allowance_bytes_per_second",
        "gauge",
        "What all daemons together may tell each other.",
        single("digests", "allowance"),
    ),
    Metric(
        "digest_told_bytes",
        "counter",
        "What this daemon told the others on the air, copies and overhead included.",
        single("digests", "told"),
    ),
    Metric(
        "digest_heard_bytes",
        "counter",
        "What others told each other on the air, as far as this daemon heard it, copies and overhead included.",
        single("digests", "heard"),
    ),
    Metric(
        "messages_refused",
        "counter",
        "Messages on Sendworthy's own keys that were not taken in, by kind.",
        by_name("refused"),
        ("kind",),
    ),
)
