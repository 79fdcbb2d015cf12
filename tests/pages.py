"""A fleet in front of the operator's page: daemons, cameras, and `sendworthy page`, all real processes and sessions."""

import http.client
import json
import os
import struct
import subprocess
import sys
import threading
from contextlib import suppress

import cv2
import numpy as np
import zenoh

from proxy.page import demo
from tests.daemons import ROOT, Running
from tests.ports import free_port
from tests.proxy.nodes import plain_session
from tests.waiting import wait_until

SPECS = """\
[[constraint]]
kind = "throughput"
limit = "{limit}"
window = 0.5

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "current"
utility = {{ kind = "video" }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}
"""


def image(number, *, red=0.0, width=320, height=240, noise=0):
    """A JPEG of a scene that moves, of which a part is red."""
    scene = np.full((height, width, 3), (90, 110, 60), np.uint8)
    if noise:
        scene += np.random.default_rng(number).integers(0, noise, scene.shape, np.uint8)
    scene[:, : int(width * red)] = (20, 20, 220)
    cv2.circle(scene, (width * (number % 40) // 40, height // 2), height // 8, (220, 200, 40), -1)
    return cv2.imencode(".jpg", scene)[1].tobytes()


class Camera:
    """An unmodified app of a robot that publishes images, so many in a second; `red` is what part of them is red."""

    def __init__(self, name, endpoint, hz, **shape):
        self.red = 0.0
        self._key, self._hz = f"robot/{name}/camera", hz
        self._plain = [image(number, **shape) for number in range(20)]
        self._reds = [image(number, red=0.4, **shape) for number in range(20)]
        self._session = plain_session("client", connect=(endpoint,), stamps=True)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self):
        self._ended.set()
        self._thread.join()
        self._session.close()

    def _run(self):
        publisher = self._session.declare_publisher(self._key)
        number = 0
        while not self._ended.wait(1.0 / self._hz):
            publisher.put((self._reds if self.red else self._plain)[number % 20])
            number += 1


class Fleet:
    """Robots r1, r2 … and a daemon `ground` of the operator, linked with it."""

    def __init__(self, folder, closing, *, robots, limit="1 Mbit/s", hz=10, obey=True, **shape):
        self.folder = folder
        mesh = []
        orders = ("--fleet.mode", "true", "--fleet.specs", "true") if obey else ()

        def start(name):
            place = folder / name / "specs.d"
            place.mkdir(parents=True)
            (place / "camera.toml").write_text(SPECS.format(limit=limit))
            links = ("--mesh.connect", json.dumps(mesh)) if mesh else ()
            mesh.append(f"tcp/127.0.0.1:{free_port()}")
            listens = ("--mesh.listen", json.dumps(mesh[-1:]))
            daemon = Running("--robot", name, "--specs.path", str(place), *listens, *links, *orders)
            closing.callback(daemon.end)
            return daemon

        self.ground, *self.robots = map(start, ["ground", *(f"r{n}" for n in range(1, robots + 1))])
        for daemon in (self.ground, *self.robots):
            daemon.wait_for("sendworthy ")
        for daemon in (self.ground, *self.robots):
            wait_until(lambda daemon=daemon: len(daemon.status()["peers"]) == robots, what="the robots to meet")
        self.cameras = []
        for n, robot in enumerate(self.robots, start=1):
            self.cameras.append(Camera(f"r{n}", robot.endpoint, hz, **shape))
            closing.callback(self.cameras[-1].close)


class World:
    """A demo that lets the page change its world: `channel` and `reds` are what it was told."""

    def __init__(self, endpoint, robots):
        self.channel, self.reds = demo.Channel(750_000.0), []
        self._robots = robots
        self._session = plain_session("client", connect=(endpoint,))
        self._queryable = self._session.declare_queryable(
            demo.ALL, zenoh.handlers.Callback(self._serve, indirect=False)
        )

    def end(self):
        self._queryable.undeclare()

    def close(self):
        self._session.close()

    def _serve(self, query):
        told = bytes(query.payload or b"")
        with query:
            try:
                if str(query.key_expr) == demo.CHANNEL:
                    self.channel = demo.Channel.read(told) if told else self.channel
                    query.reply(demo.CHANNEL, self.channel.write())
                else:
                    self.reds.extend([demo.read_red(told)] if told else [])
                    query.reply(demo.RED, json.dumps({"robots": self._robots}))
            except demo.DemoOrderError as error:
                query.reply_err(str(error))


class Served:
    """`sendworthy page` as a process; `url` and `token` are what it printed."""

    def __init__(self, *arguments, **environ):
        self.port = free_port()
        command = [sys.executable, "-m", "proxy.cli", "page", "--listen", f"127.0.0.1:{self.port}", *arguments]
        self.process = subprocess.Popen(command, cwd=ROOT, env=os.environ | environ, stdout=subprocess.PIPE, text=True)
        self.printed = self.process.stdout.readline()
        self.url, _, self.token = self.printed.split()[-1].partition("#token=")
        wait_until(self._answers, what="the page's server")

    def _answers(self):
        with suppress(OSError):
            return self.ask("GET", "/")[0] == 200

    def ask(self, method, path, told=None, **headers):
        """Send a request; return status, headers and body. The token goes with what tells something."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        sent = {"X-Sendworthy-Token": self.token} if told is not None else {}
        body = told if isinstance(told, bytes | None) else json.dumps(told).encode()
        connection.request(
            method, path, body, sent | {name.replace("_", "-"): value for name, value in headers.items()}
        )
        answer = connection.getresponse()
        found = answer.status, answer.headers, answer.read()
        connection.close()
        return found

    def told(self, path, told):
        """Tell the server something; return the status and what it answers as JSON."""
        status, _, body = self.ask("POST", path, told)
        return status, json.loads(body)

    def live(self):
        """Open the stream of all that is live."""
        return Stream(self.port)

    def end(self, number=2):
        """End it as Ctrl-C does; return its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            self.process.communicate(timeout=30)
        finally:
            self.process.kill()
        return self.process.returncode


class Stream:
    """What a browser reads: messages of a head and a body."""

    def __init__(self, port):
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
        self._connection.request("GET", "/live")
        self._answer = self._connection.getresponse()
        self.status = self._answer.status

    def next(self):
        """Return the next message; None at the end."""
        lengths = self._answer.read(8)
        if len(lengths) < 8:
            return None
        head, body = struct.unpack(">II", lengths)
        return json.loads(self._answer.read(head)), self._answer.read(body)

    def until(self, fits, patience=400):
        """Return the first message that fits."""
        for _ in range(patience):
            message = self.next()
            assert message is not None, "the stream ended"
            if fits(*message):
                return message
        raise AssertionError(f"nothing fits among {patience} messages; the last was {message[0]}")

    def close(self):
        self._connection.close()
