"""Robots on hosts of their own: the daemon as an operator starts it, and applications beside it."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import zenoh

from proxy.status.model import Status
from tests.system.ros_node import RosNode
from tests.waiting import wait_until

APPLICATION = Path(__file__).with_name("application.py")
SERVICE = Path(__file__).with_name("service.py")
SENDWORTHY = (sys.executable, "-m", "proxy.cli")
SPECS = """
[[constraint]]
kind = "throughput"
limit = "{limit}"
window = 0.5

[[information_type]]
name = "camera"
keys = ["robot/*/camera", "*/**/camera/image_raw/*/*"]
aggregation = "most_recent"
weight = 1.0
utility = {{ kind = "video" }}
"""


class Robot:
    """A daemon on a host, with everything by default but its name, its specs and the interface of its radio.

    `options` are further flags, `app` and `mesh` further lines of these tables.
    """

    def __init__(self, host, folder, *, limit, interface, options=(), app="", mesh=""):
        self.host = host
        self.name = host.name
        self._folder = folder
        self._log = folder / "log"
        self._apps = []
        self._options = options
        (folder / "specs.toml").write_text(SPECS.format(limit=limit))
        (folder / "sendworthy.toml").write_text(
            f'robot = "{self.name}"\n[app]\n{app}\n[mesh]\ninterface = "{interface}"\n{mesh}\n'
            '[specs]\npath = "specs.toml"\n'
        )
        self.start()

    def start(self):
        """Start the daemon."""
        command = (*SENDWORTHY, "run", "--config", str(self._folder / "sendworthy.toml"), *self._options)
        with self._log.open("w") as log:
            self.daemon = self.host.start(*command, stderr=log)

    def serves(self):
        """Whether the daemon has started."""
        assert self.daemon.poll() is None, self.log()
        return "sendworthy: sendworthy " in self.log()

    def log(self):
        """What the daemon has logged."""
        return self._log.read_text()

    def status(self):
        """What `sendworthy status --json` says here, as soon as the daemon answers it: a busy one takes a while."""
        said = []

        def answered():
            assert self.daemon.poll() is None, self.log()
            asked = self.host.run(*SENDWORTHY, "status", "--json")
            said.append(asked.stdout)
            return asked.returncode == 0

        wait_until(answered, what=f"an answer of {self.name}")
        status = json.loads(said[-1])
        Status.model_validate(status)
        return status

    def peers(self):
        """The names of the robots that this one knows."""
        return {peer["robot"] for peer in self.status()["peers"]}

    def wait_wanted(self, key):
        """Wait until the daemon takes `key` from its applications, as some on another robot want it."""
        wait_until(lambda: _covered(key, self.status()["daemon"]["observed"]), what=f"demand for {key} on {self.name}")

    def wait_subscribed(self, key):
        """Wait until the daemon knows that an application of its own wants `key`."""
        wait_until(lambda: _covered(key, self.status()["daemon"]["subscriptions"]), what=f"a subscription to {key}")

    def looked(self):
        """Whether the daemon has looked for applications that others find, twice since it started."""
        return self.status()["daemon"]["looks"] >= 2

    def hear(self, key, *, setting=None, host=None, **environ):
        """Start an application that subscribes to `key`; `setting` is where it has its configuration from."""
        words = (*_setting(setting), "hear", key)
        return self._started(Listener(host or self.host, self._output(), *words, **environ))

    def say(self, key, *, size, rate, block=False, setting=None, host=None, **environ):
        """Start an application that publishes on `key`: `rate` samples a second of `size` bytes."""
        words = (*_setting(setting), "say", key, str(size), str(rate), *(("block",) if block else ()))
        return self._started(Speaker(host or self.host, self._output(), *words, **environ))

    def serve(self, name):
        """Start an application that has a token, answers and publishes, all under `name`."""
        return self._started(Application(self.host, self._output(), "serve", name, program=SERVICE))

    def watch(self):
        """Start an application that sees tokens, asks and subscribes."""
        return self._started(Watcher(self.host, self._output(), "watch", program=SERVICE))

    def node(self, name):
        """Start a process with a node of ROS 2."""
        return self._started(RosNode(self.host, self._output(), name))

    def stop(self, number=signal.SIGTERM, timeout=10.0):
        """Ask the daemon to stop; return its exit code. It has to end within `timeout` seconds of a usual machine."""
        self.daemon.send_signal(number)
        wait_until(lambda: self.daemon.poll() is not None, timeout, what=f"the end of {self.name}")
        return self.daemon.returncode

    def kill(self):
        """End the daemon as a power cut does."""
        self.daemon.kill()
        self.daemon.wait()

    def close(self):
        """End everything on the robot, however it fares."""
        for app in self._apps:
            app.close()
        self.kill()
        print(f"--- log of {self.name}\n{self.log()}")

    def _output(self):
        return self._folder / f"app{len(self._apps)}"

    def _started(self, app):
        self._apps.append(app)
        wait_until(app.ready, what=f"start of an application on {self.name}")
        return app


class Application:
    """A program on a host, `application.py` if no other."""

    def __init__(self, host, output, *words, program=APPLICATION, **environ):
        self._output = output
        command = (host.python, str(program), *words)
        with output.open("w") as written:
            self._process = host.start(*command, stdin=subprocess.PIPE, stdout=written, env=os.environ | environ)

    def ready(self):
        """Whether it is connected."""
        assert self._process.poll() is None, "the application ended early"
        return bool(self.told())

    def told(self):
        """What it has printed."""
        lines = self._output.read_text().splitlines(keepends=True)
        return [json.loads(line) for line in lines if line.endswith("\n")]

    def close(self):
        """End it."""
        self._process.kill()
        self._process.communicate()


class Listener(Application):
    """An application that subscribes."""

    @property
    def asked(self):
        """When it did [s]."""
        return next(line["asked"] for line in self.told() if "asked" in line)

    def heard(self, key=None):
        """What it heard so far (of `key`), in order."""
        return [line for line in self.told() if "key" in line and key in (None, line["key"])]

    def numbers(self, key):
        """The numbers of the samples of `key` that it heard so far, in order."""
        return [sample["number"] for sample in self.heard(key)]


class Watcher(Application):
    """An application that sees what is there."""

    def samples(self):
        """What it heard, in order."""
        return [line["sample"] for line in self.told()[1:] if "sample" in line]

    def tokens(self):
        """The tokens that are alive as far as their coming and going tells."""
        seen = {line["token"]: line["alive"] for line in self.told()[1:] if "token" in line}
        return {token for token, alive in seen.items() if alive}

    def rounds(self):
        """Each round of questions: who answered, and which tokens were found."""
        return [line for line in self.told()[1:] if "answers" in line]


class Speaker(Application):
    """An application that publishes."""

    @property
    def late(self):
        """By how much a sample was published too late at most, known when it has ended [s]."""
        return self.told()[-2]["late"]

    def stop(self):
        """Let it end; return how many samples it published."""
        self._process.communicate(timeout=10)
        return self.told()[-1]


def _covered(key, expressions):
    return any(zenoh.KeyExpr(expression).includes(key) for expression in expressions)


def _setting(setting):
    return () if setting is None else (f"SETTING={setting}",)


def wait_until_met(robots, timeout=20.0):
    """Wait until each robot knows all the others and only them."""
    names = {robot.name for robot in robots}
    for robot in robots:
        wait_until(lambda robot=robot: robot.peers() == names - {robot.name}, timeout, f"{names} met by {robot.name}")
