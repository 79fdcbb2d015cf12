"""Looking for connections that go around the medium."""

import os
import socket

from studies.demo import links
from studies.demo.processes import Troupe
from tests.waiting import wait_until

LISTENER = """
import json, socket, sys
server = socket.create_server(("127.0.0.1", 0))
print(json.dumps(server.getsockname()[1]), flush=True)
connection = server.accept()[0]
sys.stdin.read()
"""


def test_a_connection_between_two_processes_is_found(tmp_path):
    """Both ends are named by their owners, once."""
    with Troupe(tmp_path) as troupe:
        other = troupe.start("other", "-c", LISTENER)
        with socket.create_connection(("127.0.0.1", other.hear(60.0))):
            owners = {os.getpid(): "tests", other.pid: "other"}
            found = [("other", "tests")]
            wait_until(lambda: links.connections(owners) == found, what="the connection to be seen")
        assert links.connections({os.getpid(): "tests"}) == []


def test_only_what_avoids_the_medium_counts():
    """An app may talk to its own node, and everybody to the medium."""
    found = [
        ("camera-r1", "node-r1"),
        ("medium", "node-r1"),
        ("camera-r2", "node-r1"),
        ("node-r1", "node-r2"),
    ]
    allowed = [("camera-r1", "node-r1"), ("camera-r2", "node-r2")]
    assert links.around(found, "medium", allowed) == [("camera-r2", "node-r1"), ("node-r1", "node-r2")]
