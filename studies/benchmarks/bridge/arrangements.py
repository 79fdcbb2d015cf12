"""What may stand between a publisher and a subscriber on one machine."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from proxy.bridge.tuning import TUNING
from studies.benchmarks.resources import private_memory, processor_time
from studies.demo.ports import free_ports
from studies.demo.processes import Process, Troupe

ARRANGEMENTS = ("direct", "router", "pieces", "pass", "enforce", "covered")
"""Nothing, a stock router, one that sends in pieces as small as a daemon's, one daemon in mode `pass`, one in `enforce`
with no spec for the keys, one with a spec."""

QUICK = tuple(name for name in ARRANGEMENTS if name != "enforce")

PIECE = str(TUNING.batch)
"""Largest piece that a daemon sends on the mesh [B]."""

PATIENCE = 30.0
"""How long a process may take to get ready [s]."""
SPEC = """
[[constraint]]
kind = "throughput"
limit = "{limit}"
window = 0.5

[[information_type]]
name = "bench"
keys = ["{key}"]
aggregation = "most_recent"
weight = 1.0
utility = {{ kind = "video" }}
"""


@dataclass(frozen=True, slots=True)
class Line:
    """A publisher and a listener, and what is `between` them (None: nothing)."""

    publisher: Process
    listener: Process
    between: Process | None

    def publish(self, *, size: int, seconds: float, rate: float = 0.0, block: bool = False) -> dict[str, float]:
        """Publish as the application does; return what it sent."""
        order = {"key": "bench/x", "size": size, "seconds": seconds, "rate": rate, "block": block}
        self.publisher.tell(order)
        return dict(self.publisher.hear(seconds + PATIENCE))

    def heard(self) -> dict[str, float | list[float]]:
        """Return what arrived since the last time, once nothing more comes."""
        self.listener.tell({})
        return dict(self.listener.hear(PATIENCE))

    def processor_time(self) -> float:
        """Return the processor time that what is between has used so far [s]."""
        return 0.0 if self.between is None else processor_time(self.between.pid)

    def private_memory(self) -> float:
        """Return the memory that nobody shares with what is between [B]."""
        return 0.0 if self.between is None else float(private_memory(self.between.pid))


@contextmanager
def arranged(name: str) -> Iterator[Line]:
    """Start the processes of an arrangement; end them afterwards."""
    app, mesh = (f"tcp/127.0.0.1:{port}" for port in free_ports(2))
    with TemporaryDirectory(prefix="sendworthy-bench-") as folder, Troupe(Path(folder)) as troupe:
        between = None if name == "direct" else _between(troupe, name, app, mesh, Path(folder))
        if between is None:
            publisher = _application(troupe, "publish", "--mode", "peer", "--listen", app)
            listener = _application(troupe, "listen", "--mode", "peer", "--connect", app)
        else:
            publisher = _application(troupe, "publish", "--connect", app)
            # Both ends of a link agree on the smaller pieces of the two.
            small = ("--piece", PIECE) if name == "pieces" else ()
            listener = _application(troupe, "listen", "--mode", "peer", "--connect", mesh, *small)
        line = Line(publisher, listener, between)
        _wait_until_linked(line)
        yield line


def _between(troupe: Troupe, name: str, app: str, mesh: str, folder: Path) -> Process:
    if name in {"router", "pieces"}:
        router = troupe.start(
            "router", "-m", "studies.demo.stock_router", "--listen", app, "--listen", mesh, "--others", "0"
        )
        router.hear(PATIENCE)
        return router
    key = "bench/**" if name == "covered" else "other/**"
    (folder / "spec.toml").write_text(SPEC.format(key=key, limit="20 Mbit/s"))
    config = folder / "sendworthy.toml"
    sides = f"[app]\nlisten = {json.dumps([app])}\n[mesh]\nlisten = {json.dumps([mesh])}\nscouting = false\n"
    mode = "pass" if name == "pass" else "enforce"
    config.write_text(f'robot = "bench"\nmode = "{mode}"\n{sides}[specs]\npath = "spec.toml"\n')
    return troupe.start("daemon", "-m", "proxy.cli", "run", "--config", str(config))


def _application(troupe: Troupe, role: str, *options: str) -> Process:
    process = troupe.start(role, "-m", "studies.benchmarks.bridge.application", role, *options)
    process.hear(PATIENCE)
    return process


def _wait_until_linked(line: Line) -> None:
    deadline = time.monotonic() + PATIENCE
    while not line.heard()["count"]:
        if time.monotonic() > deadline:
            raise TimeoutError("nothing gets through")
        line.publish(size=64, seconds=0.2, rate=50.0)
