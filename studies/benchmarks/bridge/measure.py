"""Measures all arrangements side by side, again and again in turn, so that what disturbs one disturbs all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.benchmarks.bridge.arrangements import ARRANGEMENTS, QUICK, Line, arranged
from studies.benchmarks.report import Table

SIZES = (64, 2_000, 40_000, 1_000_000)
"""Payloads [B]."""
RATES = {64: 500.0, 2_000: 500.0, 40_000: 200.0, 1_000_000: 20.0}
"""How often one is published to measure its latency [1/s]."""
MEGABYTE = 1e6


@dataclass(frozen=True, slots=True)
class Flow:
    """What went in and came through [samples/s], the part of all sent, processor time per sample between [s]."""

    sent: float
    rate: float
    part: float
    cost: float


def measure_bridge(*, quick: bool) -> list[Table]:
    """Measure latency, throughput and memory; `quick` takes seconds instead of minutes."""
    rounds, seconds, sizes = (1, 0.3, SIZES[::2]) if quick else (3, 1.5, SIZES)
    names = QUICK if quick else ARRANGEMENTS
    latencies: dict[tuple[str, int], list[float]] = {}
    flows: dict[tuple[str, int], list[Flow]] = {}
    memory: dict[str, float] = {}
    for _ in range(rounds):
        for name in names:
            with arranged(name) as line:
                for size in sizes:
                    if name != "covered":
                        latencies.setdefault((name, size), []).extend(latency(line, size, seconds))
                    flows.setdefault((name, size), []).append(flow(line, size, seconds))
                    if size == 40_000:
                        memory[name] = max(memory.get(name, 0.0), line.private_memory())
    return [_latencies(latencies, sizes, names), _throughput(flows, sizes, names), _memory(memory)]


def latency(line: Line, size: int, seconds: float) -> Sequence[float]:
    """Return the one-way latencies of paced samples [s]."""
    line.publish(size=size, seconds=seconds, rate=RATES[size])
    found = line.heard()["latencies"]
    return found if isinstance(found, list) else []


def flow(line: Line, size: int, seconds: float) -> Flow:
    """Publish as fast as it goes and return what came through."""
    before = line.processor_time()
    sent = line.publish(size=size, seconds=seconds, block=True)
    heard = line.heard()
    count, took = float(heard["count"]), float(heard["seconds"])  # type: ignore[arg-type] # both are numbers
    cost = line.processor_time() - before
    return Flow(
        sent["sent"] / sent["seconds"], count / took if took else 0.0, count / sent["sent"], cost / sent["sent"]
    )


def _latencies(found: dict[tuple[str, int], list[float]], sizes: Sequence[int], names: Sequence[str]) -> Table:
    rows = []
    for size in sizes:
        direct, router = (np.median(found[name, size]) for name in ("direct", "router"))
        for name in names[:-1]:
            p50, p99 = np.percentile(found[name, size], (50, 99))
            added = [f"{(p50 - base) * 1e3:+.3f}" for base in (direct, router)]
            rows.append((f"{size:,} B, {name}", f"{p50 * 1e3:.3f}", f"{p99 * 1e3:.3f}", *added))
    columns = ("sample, through", "p50", "p99", "p50 added to direct", "p50 added to the router")
    note = (
        "Publisher, subscriber and what is between them are processes of one machine that share its cores. `pieces`:"
        " the router's link to the subscriber carries pieces as small as a daemon's."
    )
    return Table("One-way latency [ms]", columns, tuple(rows), note)


def _throughput(found: dict[tuple[str, int], list[Flow]], sizes: Sequence[int], names: Sequence[str]) -> Table:
    rows = []
    for size in sizes:
        router = np.median([each.rate for each in found["router", size]])
        for name in names:
            flows = found[name, size]
            fields = ("sent", "rate", "part", "cost")
            sent, rate, part, cost = (np.median([getattr(each, of) for each in flows]) for of in fields)
            spent = f"{cost * 1e6:.1f}" if cost else "-"
            beside = f"{rate / router:.0%}" if router else "-"  # too few came to time them
            through = (f"{sent:,.0f}", f"{rate:,.0f}", beside, f"{part:.0%}", spent)
            rows.append((f"{size:,} B, {name}", *through))
    columns = ("sample, through", "in/s", "out/s", "of the router's", "arrived", "processor time [µs/sample]")
    note = (
        "Published with congestion control BLOCK as fast as it goes; the median of all rounds. Publisher and subscriber"
        " are Python too and share the cores. `covered`: a spec with a limit decides, and newer samples supersede."
    )
    return Table("Throughput", columns, tuple(rows), note)


def _memory(found: dict[str, float]) -> Table:
    rows = tuple((name, f"{found[name] / MEGABYTE:.0f}") for name in found if name != "direct")
    return Table("Private memory after 40 kB samples as fast as they go [MB]", ("through", "memory"), rows)
