"""Whole daemons with their cores, on real sessions over loopback."""

import itertools
import json
import math
import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import zenoh

from proxy import clock
from proxy.bridge import keys, naming
from proxy.bridge.broadcast import broadcast_options
from proxy.bridge.sessions import zenoh_session
from proxy.config import AppConfig, BridgeConfig, Config, MeshConfig, PlannerConfig
from proxy.core.model.mode import Mode
from proxy.daemon import Daemon
from proxy.errors import PortInUseError
from proxy.status.model import Status
from tests.daemons import Running
from tests.ports import free_port
from tests.proxy.jam import wait_for_jam
from tests.proxy.nodes import STEADFAST, Heard, answers, closing, free_endpoint, plain_session
from tests.waiting import wait_until
from utility_specs import Specs, load_specs
from utility_specs.constraint_tables import FLOOR

SPECS = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 0.5
[[information_type]]
name = "covered"
keys = ["covered/**"]
utility = { kind = "video" }
"""
KINDS = """
[[constraint]]
kind = "energy"
limit = "40 mJ"
window = 30
per_byte = "1 uJ"
per_message = "1 mJ"
[[constraint]]
kind = "messages"
limit = 300
window = 30
"""


class Robot:
    """A running daemon and its applications."""

    def __init__(self, stack, name, specs, connect=(), mode=Mode.ENFORCE, *, bridge=None, **mesh):
        self._stack = stack
        self.name = name
        self.app, self.mesh = free_endpoint(), free_endpoint()
        self.daemon = Daemon(
            Config(
                robot=name,
                mode=mode,
                app=AppConfig(listen=(self.app,)),
                mesh=MeshConfig(listen=(self.mesh,), connect=connect, scouting=False, **mesh),
                bridge=BridgeConfig.model_validate(bridge or {}),
                planner=PlannerConfig(iterations=50),
            ),
            specs,
        )
        self.daemon.start()
        stack.callback(self.daemon.stop)
        self.operator = self.node()

    def node(self):
        return closing(self._stack, plain_session("client", connect=(self.app,)))

    def status(self):
        (answer,) = answers(self.operator, keys.status(self.name))
        status = json.loads(answer)
        Status.model_validate(status)
        return status


@pytest.fixture
def specs(tmp_path):
    path = tmp_path / "specs.toml"
    path.write_text(SPECS)
    return load_specs(path)


@pytest.fixture
def pair(stack, specs):
    first = Robot(stack, "r1", specs)
    second = Robot(stack, "r2", specs, (first.mesh,))
    for robot in (first, second):
        wait_until(lambda robot=robot: robot.status()["peers"], what=f"{robot.name} to see the other")
    return first, second


def known(robot, key):
    """Whether another robot is known to want `key`."""
    streams = [s for s in robot.status()["streams"] if s["key"] == key and s["robot"] == robot.name]
    return streams and streams[0]["receivers"]


def test_too_much_is_dropped_and_local_apps_hear_everything(pair):
    """Ten times the limit: all of it is heard locally, part of it remotely, and every sample is accounted for."""
    publisher, local = pair[0].node(), Heard(pair[0].node(), "covered/**")
    remote = Heard(pair[1].node(), "covered/**")
    for side in ("subscriptions", "observed"):
        wait_until(lambda side=side: pair[0].status()["daemon"][side] == ["covered/**"], what="somebody to want it")
    firsts = itertools.count(1)

    def first():
        publisher.put("covered/a", "first", congestion_control=zenoh.CongestionControl.BLOCK)
        return next(firsts)

    def settled(published):
        counts = pair[0].status()["counts"]
        return counts["in"] == len(local.samples) == published and not counts["queued"]

    wait_until(lambda: first() and known(pair[0], "covered/a"), what="the receiver")
    published = next(firsts) - 1
    wait_until(lambda: settled(published), what="the first ones to be decided")
    before, started = pair[0].status()["counts"]["forwarded"], clock.monotonic()
    for i in range(100):
        publisher.put("covered/a", bytes([i]) * 1000, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: bytes(local.samples[-1].payload)[:1] == b"\x63", what="local delivery")
    assert sum(len(sample.payload) == 1000 for sample in local.samples) == 100
    wait_until(lambda: settled(published + 100), what="every sample to be decided")
    counts = pair[0].status()["counts"]
    assert counts["conserved"]
    assert counts["in"] == counts["forwarded"] + counts["dropped"]
    # 5 kB in any half a second, however long a busy machine took.
    assert counts["forwarded"] - before <= 5 * (2 * (clock.monotonic() - started) + 2)
    assert counts["dropped"]

    def arrived():
        return [bytes(sample.payload) for sample in remote.samples if len(sample.payload) == 1000]

    wait_until(lambda: len(arrived()) == counts["forwarded"] - before, what="what was forwarded")
    assert len(set(arrived())) == len(arrived())


def test_constraints_of_several_kinds_hold_at_once(stack, tmp_path):
    """Bytes, messages and energy: what binds first drops the rest, and the status shows all of them."""
    path = tmp_path / "kinds.toml"
    path.write_text(KINDS + SPECS)
    specs = load_specs(path)
    first = Robot(stack, "r1", specs)
    second = Robot(stack, "r2", specs, (first.mesh,))
    publisher, remote = first.node(), Heard(second.node(), "covered/**")
    wait_until(lambda: publisher.put("covered/a", "first") or known(first, "covered/a"), what="the receiver")
    for i in range(100):
        publisher.put("covered/a", bytes([i]) * 10, congestion_control=zenoh.CongestionControl.BLOCK)

    def counts():
        return first.status()["counts"]

    # What goes while nobody is known to want it counts apart.
    wait_until(
        lambda: publisher.put("covered/a", "later") or (remote.samples and "forwarded" in counts()["by_reason"]),
        what="one that is worth sending",
    )
    wait_until(lambda: not counts()["queued"], what="every sample to be decided")
    status = first.status()
    assert status["counts"]["conserved"]
    assert status["counts"]["by_reason"]["forwarded"] <= 60
    assert [(row["kind"], row["used"] <= row["limit"]) for row in status["budget"]] == [
        ("messages", True),
        ("throughput", True),
        ("energy", True),
    ]


def test_a_mode_switch_works_at_once_and_keeps_the_counts(pair):
    """In `pass` everything crosses, also what was being decided; the switch is confirmed, and nothing is lost by it."""
    publisher, remote = pair[0].node(), Heard(pair[1].node(), "covered/**")
    wait_until(lambda: publisher.put("covered/a", "first") or known(pair[0], "covered/a"), what="the receiver")
    assert list(answers(pair[0].operator, keys.mode("r1"), payload="pass")) == ["pass"]
    for i in range(50):
        publisher.put("covered/a", f"{i:03}" * 400, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: sum(len(p) == 1200 for p in remote.payloads) == 50, what="all of them")
    wait_until(lambda: pair[0].status()["counts"]["by_reason"].get("passed:mode", 0) >= 50, what="the count")
    status = pair[0].status()
    assert (status["mode"], status["counts"]["conserved"]) == ("pass", True)
    assert list(answers(pair[0].operator, keys.mode("r1"), payload="enforce")) == ["enforce"]
    assert pair[0].status()["mode"] == "enforce"


def test_the_status_tells_of_the_daemon(pair):
    """Beside what the core knows it shows sessions, endpoints, links and what waits."""
    daemon = pair[0].status()["daemon"]
    assert daemon["app"] == [pair[0].app]
    assert daemon["mesh"] == [pair[0].mesh]
    assert set(daemon["sessions"]) == {"app", "mesh"}
    assert [link["zid"] for link in daemon["links"]] == [pair[1].status()["zid"]]
    assert daemon["faults"] == 0
    assert Path(daemon["specs"]).is_absolute()
    assert daemon["egress"] == {"decided": 0, "passing": 0, "risked": 0}
    nothing = {"samples": 0, "bytes": 0}
    assert daemon["queue"] == {"covered": nothing, "passing": nothing, "most": {"samples": 4096, "bytes": 1 << 25}}


def test_specs_are_swapped_while_running(pair, tmp_path):
    """A key that no type covered is decided upon after the swap; the generation shows it."""
    before = pair[0].status()["specs"]
    path = tmp_path / "others.toml"
    path.write_text(SPECS.replace("covered/**", "other/**"))
    pair[0].daemon.swap_specs(load_specs(path))
    wait_until(lambda: pair[0].status()["specs"] != before, what="the new generation")
    wanted = Heard(pair[1].node(), "other/a")
    publisher = pair[0].node().declare_publisher("other/a")
    wait_until(lambda: publisher.matching_status.matching, what="the receiver")
    publisher.put("x")
    wait_until(lambda: [s["key"] for s in pair[0].status()["streams"]] == ["other/a"], what="the stream")
    wait_until(lambda: wanted.samples, what="the sample")


def test_it_is_alive_while_its_loop_runs(pair):
    """Whoever watches hears of it again and again."""
    heard = []
    pair[0].daemon.watch(lambda: heard.append(clock.monotonic()), 0.01)
    wait_until(lambda: len(heard) > 3, what="some signs of life")


def test_a_limit_becomes_adaptive_while_running(pair, tmp_path):
    """Between two daemons it leaves where it starts, while samples use it: upwards, or downwards on a busy machine."""
    path = tmp_path / "adaptive.toml"
    path.write_text(SPECS.replace('"80 kbit/s"', '"adaptive"\nceiling = "800 kbit/s"'))
    for robot in pair:
        robot.daemon.swap_specs(load_specs(path))
    wanted = Heard(pair[1].node(), "covered/a")
    publisher = pair[0].node().declare_publisher("covered/a")
    wait_until(lambda: publisher.matching_status.matching, what="the receiver")
    begin = math.sqrt(FLOOR)

    def moved():
        for _ in range(20):
            publisher.put(bytes(2000))
        (limit,) = pair[0].status()["budget"]
        return abs(limit["adaptive"]["in_force"] - begin) > 0.02

    wait_until(moved, what="another limit")
    wait_until(lambda: wanted.samples, what="a sample")


def test_a_daemon_stops_and_its_peers_notice(pair):
    """Both ports are free again, and the other robot knows that it is alone."""
    pair[1].daemon.stop()
    assert pair[1].daemon.wait(0.0)
    pair[1].daemon.stop()
    wait_until(lambda: not pair[0].status()["peers"], what="the other to notice")

    def free():
        with suppress(zenoh.ZError), plain_session("router", listen=(pair[1].app, pair[1].mesh)):
            return True

    wait_until(free, what="both ports to be free")


def test_a_port_in_use_leaves_nothing_open(stack, specs):
    """The error is one clear line, and the side that did open is closed again."""
    first = Robot(stack, "r1", specs)
    app = free_endpoint()
    config = Config(app=AppConfig(listen=(app,)), mesh=MeshConfig(listen=(first.mesh,), scouting=False))
    with pytest.raises(PortInUseError, match=rf"mesh\.listen: {first.mesh}: port in use"):
        Daemon(config, specs).start()
    closing(stack, plain_session("router", listen=(app,)))


def test_an_unreachable_peer_is_one_line_and_no_obstacle(stack, specs, caplog):
    """The daemon runs alone, says once what it misses, and links when the peer appears."""
    caplog.set_level("INFO")
    nobody = free_endpoint()
    first = Robot(stack, "r1", specs, (nobody,))
    wait_until(lambda: "still trying" in caplog.text, what="the line")
    assert caplog.text.count(f"no link to {nobody} yet") == 1
    late = Daemon(
        Config(robot="r2", app=AppConfig(listen=(free_endpoint(),)), mesh=MeshConfig(listen=(nobody,), scouting=False)),
        Specs.empty(),
    )
    late.start()
    stack.callback(late.stop)
    wait_until(lambda: first.status()["peers"], what="the peer")


def test_a_second_daemon_of_one_name_runs_under_another(stack, specs, caplog, monkeypatch):
    """It says so, and answers under the name it runs as."""
    first = Robot(stack, "r1", specs)
    monkeypatch.setattr(naming, "TUNING", replace(naming.TUNING, name_wait=60.0))
    endpoint = free_endpoint()
    mesh = MeshConfig(listen=(free_endpoint(),), connect=(first.mesh,), scouting=False)
    second = Daemon(Config(robot="r1", app=AppConfig(listen=(endpoint,)), mesh=mesh), specs)
    second.start()
    stack.callback(second.stop)
    asker = closing(stack, plain_session("client", connect=(endpoint,)))
    (answer,) = answers(asker, keys.status("*"))
    zid = json.loads(answer)["zid"]
    assert json.loads(answer)["robot"] == f"r1-{zid[:4]}"
    assert "give it a name of its own" in caplog.text


FROZEN = """
import sys
from contextlib import ExitStack
from tests.proxy.nodes import Heard, plain_session
with plain_session("peer", connect=(sys.argv[1],), steadfast=True) as session:
    heard = Heard(session, "**")
    print("ready", flush=True)
    sys.stdin.read()
"""


def test_a_mesh_that_stands_still_delays_nothing_local(stack, specs, caplog):
    """With a peer that stops reading, blocking samples pile up at egress; local apps, status and stop do not wait."""
    robot = Robot(stack, "r1", specs, mode=Mode.PASS, zenoh={"transport": {"link": {"tx": STEADFAST}}})
    frozen = subprocess.Popen(
        [sys.executable, "-c", FROZEN, robot.mesh], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert frozen.stdout.readline() == "ready\n"
        publisher, local = robot.node(), Heard(robot.node(), "free/**")
        wait_until(lambda: publisher.put("free/x", "x") or robot.status()["daemon"]["wanted"], what="the demand")
        os.kill(frozen.pid, signal.SIGSTOP)
        before = len(local.samples)
        for _ in range(100):
            publisher.put("free/x", b"x" * 100_000, congestion_control=zenoh.CongestionControl.BLOCK)
        wait_until(lambda: len(local.samples) >= before + 100, what="local delivery")
        wait_for_jam()
        assert robot.status()["daemon"]["egress"]["passing"] > 0
        robot.daemon.stop()
        assert "leaving without" in caplog.text
    finally:
        frozen.kill()
        frozen.communicate()


def test_waiting_ends_with_a_stop(stack, specs):
    """Whoever waits for the daemon goes on when somebody stops it."""
    robot = Robot(stack, "r1", specs)
    assert not robot.daemon.wait(0.01)
    stopper = threading.Thread(target=robot.daemon.stop)
    stopper.start()
    assert robot.daemon.wait(5.0)
    stopper.join()


WATCHED = """
import sys, threading
from proxy import cli
from tests.proxy.jam import wait_for_jam
threading.Thread(target=lambda: wait_for_jam() or print("jammed", file=sys.stderr), daemon=True).start()
sys.exit(cli.main())
"""


@pytest.mark.full
def test_the_process_ends_although_the_mesh_stands_still(stack):
    """A daemon process with a frozen peer obeys SIGTERM at once."""
    mesh = free_endpoint()
    steadfast = json.dumps({"transport": {"link": {"tx": STEADFAST}}}).replace(":", " =")
    options = ("--mesh.listen", f'["{mesh}"]', "--mode", "pass", "--mesh.zenoh", steadfast)
    daemon = Running(*options, program=("-c", WATCHED))
    frozen = subprocess.Popen(
        [sys.executable, "-c", FROZEN, mesh], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        daemon.wait_for("sendworthy")
        assert frozen.stdout.readline() == "ready\n"
        publisher = closing(stack, plain_session("client", connect=(daemon.endpoint,)))

        def status():
            (answer,) = answers(publisher, keys.status("*"))
            return json.loads(answer)["daemon"]

        wait_until(lambda: publisher.put("free/x", "x") or status()["wanted"], what="the demand")
        os.kill(frozen.pid, signal.SIGSTOP)
        for _ in range(100):
            publisher.put("free/x", b"x" * 100_000, congestion_control=zenoh.CongestionControl.BLOCK)
        daemon.wait_for("jammed")
        assert daemon.end() == 0
        assert any("leaving without" in line for line in daemon.lines)
    finally:
        daemon.end()
        frozen.kill()
        frozen.communicate()


IMPATIENT = """
import sys
from dataclasses import replace
from proxy import cli, daemon
daemon.TUNING = replace(daemon.TUNING, stop_time=0.0)
sys.exit(cli.main())
"""


@pytest.mark.full
def test_a_process_that_is_not_done_closing_ends_in_order():
    """It does not wait for what still closes, and is no crash to whoever started it."""
    for _ in range(3):
        daemon = Running("--mode", "pass", program=("-c", IMPATIENT))
        daemon.wait_for("sendworthy: sendworthy")
        assert daemon.end() == 0
        assert "leaving without" in daemon.lines[-1]


def broadcasting(stack, specs, size):
    """So many daemons that broadcast on loopback, linked each to each, and their group."""
    group = f"224.0.0.226:{free_port()}"
    team = []
    for n in range(1, size + 1):
        dialled = tuple(robot.mesh for robot in team)
        options = {"transport": "broadcast", "group": group, "interface": "lo"}
        team.append(Robot(stack, f"r{n}", specs, dialled, **options))
    for robot in team:
        wait_until(
            lambda robot=robot: (
                [p["transport"] for p in robot.status()["peers"]] == [f"broadcast {group}"] * (size - 1)
                and robot.status()["daemon"]["broadcast"]["heard"] == size - 1
            ),
            what=f"{robot.name} to see the others",
        )
    return team, group


def test_robots_that_broadcast_thin_a_stream_to_the_limit_whoever_hears_it(stack, specs):
    """Both receivers get the same, as much as the limit allows once; the status tells of the transport."""
    (first, *others), group = broadcasting(stack, specs, 3)
    publisher, remote = first.node(), [Heard(other.node(), "covered/**") for other in others]
    wait_until(lambda: publisher.put("covered/a", "first") or known(first, "covered/a") == 2, what="the receivers")
    numbers = itertools.count()

    def arrived(heard):
        return [int(sample.payload.to_string()) for sample in heard.samples if len(sample.payload) == 1000]

    def publish():
        publisher.put("covered/a", f"{next(numbers):01000}", congestion_control=zenoh.CongestionControl.BLOCK)

    wait_until(lambda: publish() or len(arrived(remote[0])) >= 5, what="those that are worth sending")
    wait_until(lambda: not first.status()["counts"]["queued"], what="every sample to be decided")
    wait_until(lambda: arrived(remote[0]) == arrived(remote[1]), what="the same on both")
    status = first.status()
    assert status["counts"]["conserved"]
    assert (status["transport"], status["coordination"]) == (f"broadcast {group}", "announce")
    assert status["daemon"]["broadcast"].items() >= {"group": group, "interface": "lo", "heard": 2}.items()
    assert arrived(remote[0]) == sorted(set(arrived(remote[0])))
    assert status["counts"]["dropped"] > 0


def test_a_forged_state_on_the_group_is_not_even_malformed(stack, specs):
    """What is said on Sendworthy's keys counts only on the mesh session, but for digests where there is no TLS."""
    (robot,), group = broadcasting(stack, specs, 1)
    forger = closing(stack, zenoh_session(broadcast_options(group, "lo")))
    wait_until(lambda: robot.status()["daemon"]["broadcast"]["heard"] == 1, what="the forger")
    heard = Heard(robot.node(), "**")
    wait_until(lambda: robot.status()["daemon"]["subscriptions"] == ["**"], what="the subscription")
    believed, state = f"{keys.ON_AIR}/{keys.digest('r2', 'z2')}", keys.state("r2", "z2")

    def forge():
        for key in (keys.digest("r2", "z2"), state, f"{keys.ON_AIR}/{state}", f"{keys.ON_AIR}/mark"):
            forger.put(key, "forged")

    wait_until(lambda: forge() or heard.samples, what="an ordinary sample")
    wait_until(lambda: forger.put(believed, "forged") or robot.status()["refused"], what="the digest")
    assert set(robot.status()["refused"]) == {"digest:malformed"}
    insider = closing(stack, plain_session("peer", connect=(robot.mesh,)))
    speak = partial(insider.put, state, "forged")
    wait_until(lambda: speak() or "state:unknown" in robot.status()["refused"], what="its effect")


def test_the_status_says_what_was_denied_and_what_bypassed(stack, tmp_path):
    """A bypassing sample is counted with its bytes and against the limit; denied ones by direction."""
    path = tmp_path / "patient.toml"
    path.write_text(SPECS.replace("window = 0.5", "window = 60"))  # what was used is still seen when it is asked for
    specs = load_specs(path)
    robot = Robot(stack, "r1", specs, bridge={"out": {"deny": ["secret/**"], "bypass": ["covered/stop"]}})
    other, app = Robot(stack, "r2", specs, (robot.mesh,)), robot.node()
    remote = Heard(other.node(), "**")
    wait_until(lambda: app.put("covered/stop", b"0123456789") or remote.samples, what="the other to hear")
    wait_until(lambda: robot.status()["daemon"]["wanted"], what="its demand to be known")
    before = robot.status()["counts"]["bytes"].get("passed:bypass", 0)
    for key in ("covered/stop", "secret/a", "secret/b"):
        app.put(key, b"0123456789", congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: robot.status()["counts"]["by_reason"].get("dropped:denied") == 2, what="the counts")
    wait_until(lambda: robot.status()["counts"]["bytes"].get("passed:bypass", 0) > before, what="its bytes")
    status = robot.status()
    assert set(status["counts"]["by_reason"]) == {"dropped:denied", "passed:bypass"}
    assert status["counts"]["conserved"]
    assert status["budget"][0]["used"] >= 10
    assert status["daemon"]["denied"]["out"]["samples"] == 2
