"""Hours of traffic leave nothing behind in a daemon."""

import os
import signal
import time
from pathlib import Path

import pytest

from tests.waiting import wait_until

pytestmark = pytest.mark.system

SOAK = float(os.environ.get("SOAK", "9"))
"""How long it lasts [s]; the long run has it for many minutes."""
GROWN = 6 << 20
"""What a daemon's memory may grow after the first third, by what allocators keep [B]."""

KEYS = 10
"""That are asked for by turns: a Zenoh session keeps 2.6 kB of every key that was ever subscribed to."""


LARGE = 50_000
"""Samples of this size are such that Zenoh's shared memory takes, where it is on [B]."""


def held(daemon):
    """What a process holds: memory of its own, and memory that it shares with applications [B]; threads, open files."""
    folder = Path("/proc", str(daemon.pid))
    status = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines())
    own, shared = (int(status[kind].split()[0]) << 10 for kind in ("RssAnon", "RssShmem"))
    return own, shared, int(status["Threads"]), len(list((folder / "fd").iterdir()))


def test_a_long_run_leaves_nothing_behind(team):
    """Streams cross, applications with large samples come and go, specs are reloaded: daemons stay as they were."""
    robots = team("ab")
    local, *_ = listeners = [robot.hear("bulk") for robot in robots]
    robots[0].say("robot/a/camera", size=5000, rate=30)
    robots[1].hear("robot/a/camera")
    robots[0].say("bulk", size=64, rate=200)
    wait_until(lambda: all(listener.numbers("bulk") for listener in listeners), what="samples everywhere")
    began, rounds, before = time.monotonic(), 0, None
    while time.monotonic() < began + SOAK:
        key, robot = f"brief/{rounds % KEYS}", robots[rounds % 2]
        brief = robot.hear(key)
        speaker = robot.say(key, size=LARGE, rate=50)
        robots[0].daemon.send_signal(signal.SIGHUP)
        wait_until(brief.heard, what="a large sample")
        speaker.stop()
        brief.close()
        rounds += 1
        if before is None and time.monotonic() > began + SOAK / 3:
            before = [held(robot.daemon) for robot in robots]
    after = [held(robot.daemon) for robot in robots]
    print(f"{rounds} applications and reloads in {SOAK:.0f} s")
    print(f"memory, shared memory [B], threads, files: {before}, {after}")
    for then, now in zip(before, after, strict=True):
        grown = [late - early for early, late in zip(then, now, strict=True)]
        assert all(more <= most for more, most in zip(grown, (GROWN, GROWN, 4, 8), strict=True)), grown
    numbers = local.numbers("bulk")
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
