"""Three robots that are connected in three ways: by one router, by a router each, by a daemon each.

Each robot is a host of its own. Applications are told where Zenoh is on their robot, and nothing else.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

from tests.system.network import RADIO
from tests.transparency.applications import PATIENCE, Actor, App, Names
from tests.waiting import wait_until

LOCAL = "tcp/127.0.0.1:7447"
ROBOTS = ("a", "b", "c")
_ROUTER = (sys.executable, "-m", "tests.transparency.router")
SENDWORTHY = (sys.executable, "-m", "proxy.cli")
# Processes of one host share memory and the socket that is a file; those of different hosts share neither.
_OWN_MEMORY = 'mount --bind "$0" /dev/shm && exec "$@"'
MEMORY = Path("/dev/shm")  # noqa: S108 - each host has its own
SOCKET = MEMORY / "zenoh.sock"
"""Where else a router or a daemon listens on its robot."""


class Place:
    """A host with a folder for its files. Its processes share `memory` and see it as /dev/shm."""

    def __init__(self, host, folder):
        self.host = host
        self.folder = folder
        self.memory = folder / "memory"
        self.memory.mkdir(parents=True)

    def start(self, *command, **options):
        """Start a process there."""
        return self.host.start("sh", "-c", _OWN_MEMORY, str(self.memory), *command, **options)


class Robot:
    """A robot: what serves Zenoh on it, and its applications. `app` and `other` are always there."""

    def __init__(self, name, place, team, endpoint):
        self.name = name
        self.place = place
        self._team = team
        self._endpoint = endpoint
        self.actor = Actor(place, team.names)
        self.apps = {}

    def open(self, name, actor=None, **config):
        """Open an application with `config` on top of the usual."""
        app = App(actor or self.actor, f"{self.name}.{name}", _usual(self._endpoint) | config)
        self.apps[name] = app
        return app

    def close(self, name):
        """Close an application."""
        app = self.apps.pop(name)
        app.close()

    def __getattr__(self, name):
        """The application of that name."""
        try:
            return self.__dict__["apps"][name]
        except KeyError:
            raise AttributeError(name) from None


class Team:
    """The robots of an arrangement, its processes, and the names of all that has an id."""

    def __init__(self, network, folder):
        self.names = Names()
        self.robots = {}
        self._network = network
        self._folder = folder
        self._processes = []
        self._rounds = 0
        self._places = {}

    def place(self, name):
        """The host of that name, which is made if there is none yet."""
        if name not in self._places:
            self._places[name] = Place(self._network.add(name), self._folder / name)
        return self._places[name]

    def run(self, place, *command, **options):
        """Start a process that ends with the team."""
        self._processes.append(place.start(*command, stdin=subprocess.PIPE, **options))
        return self._processes[-1]

    def add(self, name, endpoint=LOCAL):
        """Add a robot whose applications connect to `endpoint`."""
        self.robots[name] = Robot(name, self.place(name), self, endpoint)

    def __getattr__(self, name):
        """The robot of that name."""
        try:
            return self.__dict__["robots"][name]
        except KeyError:
            raise AttributeError(name) from None

    def begin(self):
        """Open the applications that are always there, and wait until all know each other."""
        for robot in self.robots.values():
            for name in ("app", "other"):
                robot.open(name)
            for router in robot.app.info()["routers"]:
                self.names.sessions[router] = "router"
        self.settle(20.0)

    def apps(self):
        """All applications."""
        return [app for robot in self.robots.values() for app in robot.apps.values()]

    def settle(self, timeout=PATIENCE):
        """Wait until what was declared or taken back so far is known everywhere.

        Whoever sees a token knows what its application had declared before: every application declares one, and waits
        for those of all others.
        """
        self._rounds += 1
        apps, watched = self.apps(), f"**/settled/{self._rounds}/*"
        waiting = {app: app.liveliness_subscriber(watched, history=True) for app in apps}
        tokens = [app.token(f"settled/{self._rounds}/{app.name}") for app in apps]
        for app, place in waiting.items():
            known = place.came(count=_within_sight(app, apps), timeout=timeout)
            assert known, f"{self}: what was declared is not known to {app.name}"
        for thing in (*waiting.values(), *tokens):
            thing.undeclare()

    def rest(self):
        """Settle, and wait until what that took back is known everywhere, too: no declaration is under way then.

        Zenoh's admin space answers while it holds the routing tables, and a router to which a declaration comes at that
        moment takes no more of them, ever.
        """
        self.settle()
        gone, until = f"**/settled/{self._rounds}/*", time.monotonic() + PATIENCE
        while any(app.tokens(gone) for app in self.apps()):
            assert time.monotonic() < until, f"{self}: what was taken back is still known"

    def flush(self):
        """Wait until what was published so far has arrived: what is published after it, and last in line, has."""
        self._rounds += 1
        apps, watched = self.apps(), f"**/flushed/{self._rounds}/*"
        waiting = {app: app.subscriber(watched) for app in apps}
        self.settle()
        mark = {"payload": "", "priority": "BACKGROUND", "congestion_control": "BLOCK"}
        for app in apps:
            app.put(f"flushed/{self._rounds - 1}/{app.name}", **mark)
        for app, place in waiting.items():
            assert place.came(count=_within_sight(app, apps)), f"{self}: what was published has not reached {app.name}"
            place.undeclare()

    def reset(self):
        """Take back what a probe has left."""
        for robot in self.robots.values():
            for name in list(robot.apps):
                if name not in ("app", "other"):
                    robot.close(name)
            robot.actor.do("reset")
        self.settle()

    def close(self):
        """End everything."""
        for robot in self.robots.values():
            robot.actor.kill()
        for process in self._processes:
            process.kill()
            process.communicate()

    def __str__(self):
        return self._folder.name


def _within_sight(app, apps):
    """How many of all applications one can see: those in a namespace see their own kind only."""
    return len(apps) if app.namespace is None else sum(other.namespace == app.namespace for other in apps)


def direct(network, folder):
    """Applications of all robots at one router."""
    team = Team(network, folder)
    place = team.place("a")
    _route(team, place, f"tcp/0.0.0.0:7447,unixsock-stream/{SOCKET}")
    for name in ROBOTS:
        team.add(name, f"tcp/{place.host.address}:7447")
    return team


def routers(network, folder):
    """A router on each robot, all linked over the channel."""
    team = Team(network, folder)
    known = []
    for name in ROBOTS:
        place = team.place(name)
        _route(team, place, f"{LOCAL},tcp/{place.host.address}:7447,unixsock-stream/{SOCKET}", *known)
        known.append(f"tcp/{place.host.address}:7447")
        team.add(name)
    return team


def daemons(network, folder):
    """A daemon on each robot, with everything by default but its name, its mode and the interface of its radio."""
    team = Team(network, folder)
    logs = [serve(team, team.place(name)) for name in ROBOTS]
    for log in logs:
        wait_until(lambda log=log: "sendworthy: sendworthy " in log.read_text(), 20.0, f"start of {log.parent.name}")
    for name in ROBOTS:
        team.add(name)
    return team


def serve(team, place, configuration=""):
    """Start a daemon; return its log."""
    file, log = place.folder / "sendworthy.toml", place.folder / "log"
    file.write_text(
        f'robot = "{place.host.name}"\nmode = "pass"\n'
        f'[app]\nlisten = ["{LOCAL}", "unixsock-stream/{SOCKET}"]\n'
        f'[mesh]\ninterface = "{RADIO}"\n{configuration}'
    )
    with log.open("w") as written:
        team.run(place, *SENDWORTHY, "run", "--config", str(file), stderr=written, env=dict(os.environ))
    return log


def _route(team, place, listen, *connect):
    process = team.run(place, *_ROUTER, listen, *connect, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"


def _usual(endpoint):
    """The configuration of an application, as deploy/apps/client.json5; without shared memory."""
    return {
        "mode": "client",
        "connect": {"endpoints": [endpoint], "timeout_ms": 10_000},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {"shared_memory": {"enabled": False}},
    }


ARRANGEMENTS = {"direct": direct, "routers": routers, "daemons": daemons}
