"""A process of ROS 2 on a robot, as a program: a node that knows localhost:7447 and nothing else.

    python -m tests.system.rmw_application NAME

Each line of standard input is a command, a list in JSON: the name of a method of `Node` and its arguments, payloads as
text. What is heard, answered and seen is printed, one line of JSON each; the first one is "ready".
"""

import json
import sys

from tests.ros2.node import Node


class Program:
    """Carries out commands on a node."""

    def __init__(self, name):
        self._node = Node(name)
        self._clients = {}

    def run(self):
        """Serve standard input until it ends."""
        tell("ready")
        for line in sys.stdin:
            command, *words = json.loads(line)
            getattr(self, command, getattr(self._node, command, None))(*words)
        self._node.close()

    def publish(self, topic, text):
        """Publish, and tell with which attachment."""
        tell({"sent": topic, "payload": text, "attachment": self._node.publish(topic, text.encode()).hex()})

    def latch(self, topic):
        """Create a publisher of a latched topic."""
        self._node.advertise(topic, latched=True)

    def subscribe_latched(self, topic):
        """Create a subscription to a latched topic."""
        self._node.subscribe(topic, latched=True)

    def heard(self, topic):
        """Tell what was heard so far."""
        pairs = [[payload.decode(), attachment.hex()] for payload, attachment in self._node.heard[topic]]
        tell({"heard": topic, "messages": pairs})

    def graph(self):
        """Tell what is in the graph."""
        tell({"graph": sorted(self._node.graph())})

    def call(self, service, text):
        """Call a service, and tell the answers."""
        if service not in self._clients:
            self._clients[service] = self._node.client(service)
        answers = self._clients[service](text.encode())
        tell({"answers": [[payload.decode(), fitting] for payload, fitting in answers]})


def tell(message):
    """Print a line of JSON at once."""
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    Program(sys.argv[1]).run()
