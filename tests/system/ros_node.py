"""Processes of ROS 2 on a host, and what a test asks of them."""

import json
import subprocess
import sys

from tests.waiting import wait_until


class RosNode:
    """A process of `rmw_application.py` on a host; see there for the commands."""

    def __init__(self, host, output, name):
        self.name = name
        self._output = output
        with output.open("w") as written:
            command = (sys.executable, "-m", "tests.system.rmw_application", name)
            self._process = host.start(*command, stdin=subprocess.PIPE, stdout=written, text=True)

    def ready(self):
        """Whether it is connected."""
        assert self._process.poll() is None, "the node ended early"
        return bool(self._told())

    def do(self, *command):
        """Let it carry out a command that is not answered."""
        self._process.stdin.write(json.dumps(command) + "\n")
        self._process.stdin.flush()

    def ask(self, *command):
        """Let it carry out a command; return the answer."""
        before = len(self._told())
        self.do(*command)
        wait_until(lambda: len(self._told()) > before, 30.0, f"the answer of {self.name} to {command}")
        return self._told()[before]

    def heard(self, topic):
        """What it heard of a topic: payloads and attachments, in order."""
        return self.ask("heard", topic)["messages"]

    def graph(self):
        """What it sees in the graph: (kind, node, topic)."""
        return {tuple(entity) for entity in self.ask("graph")["graph"]}

    def shut_down(self):
        """Let the node end as it should."""
        self._process.communicate(timeout=20)

    def close(self):
        """End it."""
        self._process.kill()
        if not self._process.stdin.closed:
            self._process.communicate()

    def _told(self):
        lines = self._output.read_text().splitlines(keepends=True)
        return [json.loads(line) for line in lines if line.endswith("\n")]
