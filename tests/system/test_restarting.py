"""What a restart of the daemon costs applications that have the snippet."""

import time
from itertools import pairwise
from pathlib import Path

import pytest

from tests.waiting import wait_until

pytestmark = pytest.mark.system

CLIENT = str(Path(__file__).parent.parent.parent / "deploy" / "apps" / "client.json5")
RATE = 100
RESTARTS = 3


def test_a_restart_of_the_daemon_heals_for_local_and_remote_applications(team):
    """Killed and started again, the daemon gives applications of the robot and of others the same samples as before."""
    robots = team()
    listeners = [robot.hear("a", setting=CLIENT) for robot in robots[:2]]
    speaker = robots[0].say("a", size=20, rate=RATE, setting=CLIENT)
    for _ in range(RESTARTS):
        for listener in listeners:
            wait_until(lambda listener=listener: listener.heard(), what="a sample")
        robots[0].kill()
        killed = time.monotonic()
        counts = [len(listener.heard()) for listener in listeners]
        robots[0].start()
        wait_until(robots[0].serves, what="the start")
        print(f"started {time.monotonic() - killed:.2f} s after it was killed")
        for listener, count in zip(listeners, counts, strict=True):
            wait_until(lambda listener=listener, count=count: len(listener.heard()) > count + RATE, 30, "samples again")
        for place, listener in zip(("local", "remote"), listeners, strict=True):
            print(f"{place}: heard again {first(listener, killed) - killed:.2f} s after")
    total = speaker.stop()
    for place, listener in zip(("local", "remote"), listeners, strict=True):
        wait_until(lambda listener=listener: listener.numbers("a")[-1] == total - 1, what="the last sample")
        heard = listener.numbers("a")
        assert heard == sorted(set(heard))
        gaps = sorted((after - before for before, after in pairwise(heard)), reverse=True)[:RESTARTS]
        print(f"{place}: {', '.join(f'{gap / RATE:.2f} s' for gap in gaps)} without samples")


def first(listener, moment):
    """When the first sample that was said 0.1 s after `moment` or later was heard."""
    return next(sample["heard"] for sample in listener.heard() if sample["sent"] > moment + 0.1)
