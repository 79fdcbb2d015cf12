"""A daemon that decides nothing stays small: what decisions compute with is loaded when there are any."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from proxy import clock
from proxy.core.core import Core
from proxy.core.interface.events import PeerAppeared, SamplePublished, StateHeard
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import State
from proxy.loop import Loop
from proxy.preparing import MANY, MODULE
from tests.ports import free_port
from tests.waiting import wait_until
from utility_specs import load_specs

SPECS = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
[[information_type]]
name = "covered"
keys = ["covered/**"]
utility = { kind = "exponential", tau = "1 s" }
"""
HEAVY = {"numpy", "cv2", "scipy", "matplotlib"}
"""What decisions are computed with."""
EXTRAS = {"mcap", "prometheus_client", "rich", "shtab", "rosbags"}
SERVERS = {"asyncio", "email", "html", "http", "socketserver", "ssl", "xml"}
"""What only the pages of others are served with, 6 MB of it. `importlib.metadata` loads some of it, too."""
FOR_MISTAKES = {"difflib", "unicodedata"}
OTHERS = {
    *("importlib.metadata", "multiprocessing", "csv", "zipfile"),
    *("planner.tables", "planner._native", "proxy.profiling._native"),
    *("proxy.metrics.server", "proxy.metrics.exposition", "proxy.recording.recorder", "proxy.status"),
    *("proxy.commands.status", "proxy.commands.client", "proxy.top", "proxy.decisions_text", "proxy.quantities"),
}
"""Parts of what else only other commands need, and what a daemon does not do that is not asked to."""
IDLE = """
import sys
from pathlib import Path
import proxy.commands.run
from proxy.config import AppConfig, Config, MeshConfig, MetricsConfig, RecordConfig
from proxy.daemon import Daemon
from utility_specs import load_specs
app, mesh, specs, metrics, folder = sys.argv[1:]
config = Config(
    robot="r0",
    metrics=MetricsConfig(listen=metrics),
    record=RecordConfig(on=bool(folder), folder=Path(folder)),
    app=AppConfig(listen=(f"tcp/127.0.0.1:{app}",)),
    mesh=MeshConfig(listen=(f"tcp/127.0.0.1:{mesh}",), scouting=False),
)
daemon = Daemon(config, load_specs(Path(specs)))
daemon.start()
daemon.swap_specs(load_specs(Path(specs)))
print(*sorted(sys.modules))
daemon.stop()
"""
SEARCH = """
import sys
from planner import Message, Problem, SearchSettings, Step, Stream, Throughput, start
message = Message(0, 0.0, 0.0, 0.1, Step(1.0, 1.0), 1.0, (100.0,))
problem = Problem((Stream(0),), (message,), 0, (Throughput(1e4).constraint("c"),), (), 0.0, 2.0)
for name in ("best", "paper"):
    search = start(problem, SearchSettings(search=name))
    search.run(100)
    assert search.plan().send
print(*sorted({name.partition(".")[0] for name in sys.modules}))
"""


def modules(code, *arguments):
    """Return what a process has imported that runs this code."""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("COV")}  # it imports much
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], env=environ, capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()[-1].split()


@pytest.fixture
def specs(tmp_path) -> Path:
    path = tmp_path / "spec.toml"
    path.write_text(SPECS)
    return path


def test_a_daemon_that_has_nothing_to_decide_imports_nothing_heavy(specs):
    """That holds with specs in force, as long as nothing that they cover goes through it."""
    imported = modules(IDLE, free_port(), free_port(), specs, "", "")
    assert (HEAVY | EXTRAS | SERVERS | FOR_MISTAKES | OTHERS).isdisjoint(imported)


@pytest.mark.full
def test_a_daemon_that_is_watched_imports_no_servers_of_others(specs, tmp_path):
    """Nor what only reads recordings: OpenSSL, what reads mail and archives would be 8 MB of it."""
    imported = modules(IDLE, free_port(), free_port(), specs, f"127.0.0.1:{free_port()}", tmp_path / "recordings")
    assert {"proxy.metrics.exposition", "proxy.recording.snapshots", "proxy.recording.mcap_file"} <= set(imported)
    others = HEAVY | SERVERS | {"prometheus_client", "lz4", "csv", "zipfile", "importlib.metadata"}
    assert others.isdisjoint(imported)


def test_a_search_of_the_native_engine_needs_no_numpy():
    """Problems of standard kinds are tabulated, searched and answered without."""
    assert "numpy" not in modules(SEARCH)


@pytest.fixture
def loop(specs, monkeypatch):
    """A loop in a process in which no market was loaded yet."""
    monkeypatch.delitem(sys.modules, MODULE, raising=False)
    loop = Loop(Core(CoreSettings("r1", "z1"), load_specs(specs), clock.monotonic()), lambda _: None)
    loop.start()
    yield loop
    loop.close(1.0)
    for thread in threading.enumerate():
        if thread.name == "prepare":  # what it imports must not be taken from it half-way
            thread.join(60.0)


def test_what_a_market_computes_with_is_loaded_with_the_first_stream_that_a_spec_covers(loop):
    """Other keys are no reason to."""
    for number, key in enumerate(("other", "covered/a")):
        assert loop.ask(lambda: len(loop.core.view.streams), 10.0) == 0
        assert MODULE not in sys.modules
        now = clock.monotonic()
        loop.post(SamplePublished(now, number, key, 100, now, None, 5, {}, delete=False))
    wait_until(lambda: MODULE in sys.modules)


def test_it_is_there_before_the_first_sample_where_another_robot_wants_what_a_spec_covers(loop):
    """A robot that is there is no reason to, nor is one that wants something else."""
    loop.post(PeerAppeared(clock.monotonic(), "op", "z-op"))
    for wanted in ((), ("other/**",), ("covered/a/*",)):
        assert loop.ask(lambda: loop.feed.preparation.begun, 10.0) is False
        assert MODULE not in sys.modules
        loop.post(StateHeard(clock.monotonic(), State("op", "z-op", "enforce", "", (), wanted)))
    wait_until(lambda: MODULE in sys.modules)
    assert len(loop.core.view.streams) == 0


def test_it_is_there_as_soon_as_zenoh_says_that_somebody_wants_what_a_spec_covers(loop, specs):
    """The state of a robot may come later. Nothing is loaded where nothing is limited."""
    unlimited = specs.with_name("unlimited.toml")
    unlimited.write_text(SPECS[SPECS.index("[[information_type]]") :])
    for wanted, these in ((("other/**",), specs), (("covered/*",), unlimited)):
        loop.feed.preparation.wanted(wanted, load_specs(these))
        assert not loop.feed.preparation.begun
    loop.feed.preparation.wanted(("covered/*",), load_specs(specs))
    wait_until(lambda: MODULE in sys.modules)


def test_of_very_many_wanted_keys_none_is_looked_for(loop, specs):
    """To look through them for each that comes would take longer than to load."""
    loop.feed.preparation.wanted([f"other/{number}" for number in range(MANY + 1)], load_specs(specs))
    wait_until(lambda: MODULE in sys.modules)
