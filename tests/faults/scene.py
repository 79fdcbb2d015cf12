"""Robots under a fault: what is published is numbered, and each sample is accounted for.

`Scene` has robots that are linked each to each, one that publishes and others that hear. A *fault* is a small class
with `start` and `stop`, a context of its own test. After it the scene checks what always holds: nothing accepted is
lost without a reason, nothing comes twice or out of order, samples on the robot itself are complete, memory is bounded.
"""

import itertools
import json
import os
import struct
import threading
from pathlib import Path

import zenoh

from tests.daemons import Running
from tests.ports import free_port
from tests.proxy.counting import Counting
from tests.proxy.nodes import closing, plain_session
from tests.waiting import wait_until

SPECS = """
[[constraint]]
kind = "throughput"
limit = "{limit}"
window = 0.5

[[information_type]]
name = "camera"
keys = ["camera/*"]
aggregation = {aggregation}
utility = {{ kind = "video" }}
"""
GROWTH = 48 << 20
"""What a daemon may take more after a fault than before: half of it are queues that may fill, 32 MiB by default [B]."""
SHARED = 1 << 20
"""What it may share with applications [B]."""
_HEAD = struct.Struct("<Q")
RETRY = {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1.5}


class Robot:
    """A daemon that can be started again where it was, and its applications."""

    def __init__(self, name, specs, *, dialled, options, program, environ):
        self.name = name
        self.app, self.mesh = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
        self._flags = ("--robot", name, "--specs.path", str(specs), "--mesh.listen", json.dumps([self.mesh]), *options)
        self._dialled = ("--mesh.connect", json.dumps(list(dialled)))
        self._how = {"program": program, **environ}

    def start(self):
        """Start the daemon."""
        self.daemon = Running(*self._flags, *self._dialled, endpoint=self.app, **self._how)
        self.daemon.wait_for("sendworthy: sendworthy ")
        self._reader = threading.Thread(target=_read, args=(self.daemon,), daemon=True)
        self._reader.start()

    @property
    def pid(self):
        return self.daemon.process.pid

    def log(self):
        """What the daemon has logged since it was started."""
        return "".join(self.daemon.lines)

    def status(self):
        return self.daemon.status()

    def peers(self):
        return {peer["robot"] for peer in self.status()["peers"]}

    def memory(self):
        """Memory of its own, and memory shared with others [B]."""
        lines = Path(f"/proc/{self.pid}/status").read_text().splitlines()
        held = dict(line.split(":", 1) for line in lines)
        return tuple(int(held[kind].split()[0]) << 10 for kind in ("RssAnon", "RssShmem"))

    def processor_time(self):
        """What the daemon has computed since it was started [s]."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(") ")[2].split()
        return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")

    def end(self):
        """End the daemon, however it fares."""
        self.daemon.process.kill()
        self.daemon.process.wait()
        self._reader.join()
        self.daemon.process.stderr.close()


def _read(daemon):
    """Take in what a daemon logs: a full pipe would stop it."""
    for line in daemon.process.stderr:
        daemon.lines.append(line)


class Numbers:
    """The numbers of the samples that an application heard of a key, in order."""

    def __init__(self, session, key):
        self.heard = []
        session.declare_subscriber(key, zenoh.handlers.Callback(self._take, indirect=False))

    def _take(self, sample):
        self.heard.append(_HEAD.unpack(sample.payload.to_bytes()[: _HEAD.size])[0])

    @property
    def last(self):
        return self.heard[-1] if self.heard else -1


class Speaker:
    """Publishes numbered samples on a key at a steady rate, until it is stopped; `said` is how many."""

    def __init__(self, session, key, *, size, rate):
        self.said = 0
        self._publisher = session.declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
        self._rest, self._pause = bytes(size - _HEAD.size), 1.0 / rate
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self):
        self._stopped.set()
        self._thread.join()

    def _run(self):
        while not self._stopped.wait(self._pause):
            self._publisher.put(_HEAD.pack(self.said) + self._rest)
            self.said += 1


class Scene:
    """Robots by name; the first one publishes on a `key`, which all hear, and an application of the first one, too.

    With `relays` links go by relays, which `relays` has by the names of their ends. Traffic is so much as the `limit`
    has room for unless another `size` [B] or `rate` [1/s] is given. All ends with `closing`.
    """

    def __init__(
        self,
        folder,
        closing,
        *,
        names="ab",
        key="camera/a",
        limit="4 Mbit/s",
        size=1000,
        rate=50,
        relays=False,
        aggregation='"most_recent"',
        options=(),
        programs=None,
        **environ,
    ):
        self._closing = closing
        self.relays, self.robots = {}, {}
        self.specs = folder / f"{names[0]}.d" / "specs.toml"
        for name in names:
            dialled = [self._way(name, other) if relays else other.mesh for other in self.robots.values()]
            place = folder / f"{name}.d"
            place.mkdir()
            (place / "specs.toml").write_text(SPECS.format(limit=limit, aggregation=aggregation))
            program = (programs or {}).get(name, ("-m", "proxy.cli"))
            self.robots[name] = Robot(name, place, dialled=dialled, options=options, program=program, environ=environ)
        for robot in self.robots.values():
            robot.start()
            self._closing.callback(self._end, robot)
        self.first, *self.others = self.robots.values()
        self.local = Numbers(self.application(self.first), key)
        self.remote = [Numbers(self.application(robot), key) for robot in self.others]
        self.meet()
        wait_until(lambda: key in self.first.status()["daemon"]["observed"], what="demand")
        self.speaker = Speaker(self.application(self.first), key, size=size, rate=rate)
        self._closing.callback(self.speaker.stop)
        self.go_on()
        self._before = {robot.name: robot.memory() for robot in self.robots.values()}

    def _way(self, name, other):
        relay = self._closing.enter_context(Counting(other.mesh))
        self.relays[other.name + name] = relay
        return relay.endpoint

    def application(self, robot):
        """A plain Zenoh application on a robot, which comes back to its daemon by itself."""
        return closing(self._closing, plain_session("client", connect=(robot.app,), retry=RETRY))

    def meet(self, timeout=30.0):
        """Wait until each robot knows all the others, and nobody else."""
        for robot in self.robots.values():
            expected = self.robots.keys() - {robot.name}
            wait_until(lambda robot=robot, expected=expected: robot.peers() == expected, timeout, "the robots to meet")

    def go_on(self, timeout=30.0, *, listeners=None):
        """Wait until samples that are published from now on are heard, by all or by some `listeners`."""
        now = self.speaker.said
        for numbers in (self.local, *self.remote) if listeners is None else listeners:
            wait_until(lambda numbers=numbers: numbers.last > now, timeout, "new samples")

    def stop(self):
        """Stop publishing; return how many samples were published."""
        self.speaker.stop()
        return self.speaker.said

    def finish(self, *, whole_local=True, counted=True, ordered=True, most=None, growth=GROWTH):
        """Stop publishing, and check what always holds. Return the counts of who published, at the end.

        `whole_local`: its own application misses nothing. `counted`: its daemon has lived all the time, so that what
        was heard can be compared with what it says to have forwarded. `ordered`: of its stream only the newest waits.
        `most`: so many samples were published in all, where that were others, too. `growth`: a daemon may take so
        much more memory than before [B].
        """
        said = self.stop()
        for numbers in (self.local, *self.remote):
            assert len(numbers.heard) == len(set(numbers.heard)), "a sample came twice"
            wrong = [pair for pair in itertools.pairwise(numbers.heard) if pair[0] > pair[1]]
            assert not (wrong and ordered), f"out of order: {wrong}"
        if whole_local:
            wait_until(lambda: len(self.local.heard) == said, what=f"all {said} samples on the robot itself")
        wait_until(lambda: self.first.status()["counts"]["queued"] == 0, what="the end of what waits")
        counts = self.first.status()["counts"]
        for robot in self.robots.values():
            assert robot.status()["counts"]["conserved"], robot.name
        assert counts["in"] == counts["forwarded"] + counts["dropped"] <= (most or said)
        assert sum(counts["by_reason"].values()) == counts["in"]
        if counted:
            assert all(len(numbers.heard) <= counts["forwarded"] for numbers in self.remote)
        self.assert_bounded(growth)
        return counts

    def assert_bounded(self, growth):
        """No daemon holds much more than before the fault."""
        for robot in self.robots.values():
            (own, shared), (before, _) = robot.memory(), self._before[robot.name]
            assert own - before < growth, f"{robot.name}: {before} B before, {own} B now"
            assert shared < SHARED, f"{robot.name}: {shared} B shared"

    def _end(self, robot):
        robot.end()
        print(f"--- log of {robot.name}\n{robot.log()}")


class Fault:
    """Something that happens to a scene for a while."""

    def start(self):
        raise NotImplementedError

    def stop(self):
        """It is over."""

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.stop()
