"""Applications that hang do not hold up the others on their robot."""

import json
import signal
import subprocess
import sys
import threading

import pytest
import zenoh

from tests.daemons import Running
from tests.ports import free_port
from tests.proxy.nodes import STEADFAST, Heard, closing, plain_session, wait_matching
from tests.waiting import wait_until

APP = """
import sys
from tests.proxy.nodes import plain_session
session = plain_session("client", connect=(sys.argv[1],), steadfast=True)
subscriber = session.declare_subscriber(sys.argv[2], lambda sample: None)
sys.stdin.read()
"""
ROBOT = """
import sys, threading, zenoh
from tests.proxy.nodes import plain_session, wait_matching
session = plain_session("peer", connect=(sys.argv[1],), steadfast=True)
wait_matching(session, sys.argv[2])
print("ready", flush=True)
sys.stdin.readline()
done = 0
def watch():
    seen, stood = 0, False
    while True:
        threading.Event().wait(0.2)
        stands = done == seen > 0
        if stands is not stood:
            print("stands" if stands else "moves", flush=True)
        seen, stood = done, stands
threading.Thread(target=watch, daemon=True).start()
while True:
    session.put(sys.argv[2], bytes(50_000), congestion_control=zenoh.CongestionControl.BLOCK)
    done += 1
"""
"""It publishes as fast as it is let, and says so when it is let no longer, and when it is again."""
HANGING = 3
"""So many applications hang at once, each with a robot that publishes to it."""
SAMPLES = 20
"""So many go from one application to another while all robots stand, each when the one before has arrived. Zenoh gives
none up that hangs meanwhile. Where the daemon has one thread that receives (`ZENOH_RUNTIME`) none arrives."""


class Robot:
    """A robot that publishes to an application, and what it said last."""

    def __init__(self, stack, mesh, key):
        self.said = ""
        self._process = process(stack, ROBOT, mesh, key)
        threading.Thread(target=self._read, daemon=True).start()

    def start(self):
        """Publish from now on."""
        self._process.stdin.write("go\n")
        self._process.stdin.flush()

    def _read(self):
        for line in self._process.stdout:
            self.said = line.strip()


def process(stack, source, *arguments):
    """A Zenoh node as a process of its own, which ends with the test."""
    started = stack.enter_context(
        subprocess.Popen(
            [sys.executable, "-c", source, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
    )
    stack.callback(started.kill)
    return started


@pytest.mark.full
def test_apps_that_hang_hold_up_nobody_else(stack):
    """Robots publish to them with BLOCK, so Zenoh's threads wait for them: others hear each other all the same."""
    mesh = f"tcp/127.0.0.1:{free_port()}"
    steadfast = json.dumps({"transport": {"link": {"tx": STEADFAST}}}).replace(":", " =")
    daemon = Running("--mesh.listen", f'["{mesh}"]', "--app.zenoh", steadfast)
    stack.callback(daemon.end)
    daemon.wait_for("everything passes")
    keys = [f"hanging/{i}" for i in range(HANGING)]
    hanging = [process(stack, APP, daemon.endpoint, key) for key in keys]
    robots = [Robot(stack, mesh, key) for key in keys]
    wait_until(lambda: all(robot.said == "ready" for robot in robots))
    apps = [closing(stack, plain_session("client", connect=(daemon.endpoint,))) for _ in range(2)]
    heard = Heard(apps[0], "lively")
    wait_matching(apps[1], "lively")
    for app in hanging:
        app.send_signal(signal.SIGSTOP)
    for robot in robots:
        robot.start()
    lively = 0

    def arrived():
        """Whether enough have since a robot moved last: on a busy machine one stands for a moment for other reasons."""
        nonlocal lively
        count = len(heard.samples)
        apps[1].put("lively", str(count), congestion_control=zenoh.CongestionControl.BLOCK)
        wait_until(lambda: len(heard.samples) > count, what="a sample beside apps that hang")
        lively = lively + 1 if all(robot.said == "stands" for robot in robots) else 0
        return lively == SAMPLES

    wait_until(arrived, what=f"{SAMPLES} samples while all robots stand")
    assert heard.payloads == [str(i) for i in range(len(heard.samples))]
