"""Applications that hang do not hold up the others on their robot."""

import signal
import subprocess
import sys

import zenoh

from tests.daemons import Running
from tests.ports import free_port
from tests.proxy.nodes import Heard, closing, plain_session, wait_matching
from tests.waiting import wait_until

APP = """
import sys
from tests.proxy.nodes import plain_session
session = plain_session("client", connect=(sys.argv[1],))
subscriber = session.declare_subscriber(sys.argv[2], lambda sample: None)
sys.stdin.read()
"""
ROBOT = """
import sys, zenoh
from tests.proxy.nodes import plain_session, wait_matching
session = plain_session("peer", connect=(sys.argv[1],))
wait_matching(session, sys.argv[2])
print("ready", flush=True)
sys.stdin.readline()
while True:
    session.put(sys.argv[2], bytes(50_000), congestion_control=zenoh.CongestionControl.BLOCK)
"""
HANGING = 3
"""So many applications hang at once, each with a robot that publishes to it."""
SAMPLES = 500
"""So many go from one application to another meanwhile, each when the one before has arrived."""
LATE = 1.0
"""Zenoh gives up an application that takes nothing for 5 s; nobody waits for as long [s]."""


def process(stack, source, *arguments):
    """A Zenoh node as a process of its own, which ends with the test."""
    started = subprocess.Popen(
        [sys.executable, "-c", source, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    stack.callback(started.communicate)
    stack.callback(started.kill)
    return started


def test_apps_that_hang_hold_up_nobody_else(stack):
    """Robots publish to them with BLOCK, so Zenoh's threads wait for them: others hear each other all the same."""
    mesh = f"tcp/127.0.0.1:{free_port()}"
    daemon = Running("--mesh.listen", f'["{mesh}"]')
    stack.callback(daemon.end)
    daemon.wait_for("everything passes")
    keys = [f"hanging/{i}" for i in range(HANGING)]
    hanging = [process(stack, APP, daemon.endpoint, key) for key in keys]
    robots = [process(stack, ROBOT, mesh, key) for key in keys]
    assert [robot.stdout.readline() for robot in robots] == ["ready\n"] * HANGING
    apps = [closing(stack, plain_session("client", connect=(daemon.endpoint,))) for _ in range(2)]
    heard = Heard(apps[0], "lively")
    wait_matching(apps[1], "lively")
    for app in hanging:
        app.send_signal(signal.SIGSTOP)
    for robot in robots:
        robot.stdin.write("go\n")
        robot.stdin.flush()
    for i in range(SAMPLES):
        apps[1].put("lively", str(i), congestion_control=zenoh.CongestionControl.BLOCK)
        wait_until(lambda i=i: len(heard.samples) > i, LATE, f"sample {i}")
    assert heard.payloads == [str(i) for i in range(SAMPLES)]
