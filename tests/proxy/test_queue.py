"""What waits in whole daemons on its way out: samples of any size, and bursts that the limits have room for."""

import json

import pytest
import zenoh

from proxy.bridge import keys
from proxy.config import AppConfig, Config, MeshConfig, QueueConfig
from proxy.daemon import Daemon
from tests.proxy.nodes import Heard, answers, closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until
from utility_specs import load_specs

SPECS = """
[[constraint]]
kind = "throughput"
limit = "800 Mbit/s"
window = 2
[[information_type]]
name = "covered"
keys = ["covered/**"]
aggregation = "sum"
utility = { kind = "step", lifetime = 3600 }  # worth as much however busy the machine is
"""
SIZE = 20_000_000
SAMPLES, KEYS = 1800, 200


@pytest.fixture
def apps(stack, tmp_path):
    """Make two linked robots, each with an application; on the first one little may wait."""

    def make(**queue):
        path = tmp_path / "specs.toml"
        path.write_text(SPECS)
        app, mesh = [free_endpoint() for _ in range(2)], [free_endpoint() for _ in range(2)]
        for n in range(2):
            daemon = Daemon(
                Config(
                    robot=f"r{n}",
                    app=AppConfig(listen=(app[n],)),
                    mesh=MeshConfig(listen=(mesh[n],), connect=tuple(mesh[:n]), scouting=False),
                    queue=QueueConfig(**queue),
                ),
                load_specs(path),
            )
            daemon.start()
            stack.callback(daemon.stop)
        near, far = (closing(stack, plain_session("client", connect=(endpoint,))) for endpoint in app)
        heard = Heard(far, "**")
        wait_matching(near, "covered/0")

        def held():
            (status,) = answers(near, keys.status("r0"))
            return json.loads(status)["budget"][0]["held"]

        wait_until(lambda: held() > SIZE, what="the robots to share the limit")
        return near, heard

    return make


@pytest.mark.parametrize("kind", ["covered", "free"])
def test_a_sample_crosses_however_little_may_wait(apps, kind):
    """One that is decided on and one that only passes, both 300 times as large as all that may wait together.

    Each is the first of its stream: of one that seems to publish such every few milliseconds some are dropped.
    """
    near, heard = apps(bytes=65536)
    wait_until(lambda: near.put(f"{kind}/small", b"here") or heard.samples, what="the other robot")
    near.put(f"{kind}/large", bytes(SIZE), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: any(len(sample.payload) == SIZE for sample in heard.samples), what="the large sample")


@pytest.mark.full
def test_a_burst_that_the_limits_have_room_for_arrives_in_full(apps):
    """More samples of each stream, and in all, than can be decided one by one in that time."""
    near, heard = apps()
    wait_until(lambda: near.put("covered/0", b"here") or heard.samples, what="the other robot")
    for n in range(SAMPLES):
        near.put(f"covered/{n % KEYS}", str(n), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: {sample.payload.to_string() for sample in heard.samples} >= set(map(str, range(SAMPLES))))
