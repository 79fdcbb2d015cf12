"""The applications to begin with."""

import ast
import os
import shutil
import subprocess
import sys

from tests.daemons import ROOT, Running
from tests.proxy.nodes import Heard, plain_session
from tests.waiting import wait_until

APPS = ROOT / "deploy" / "apps"


def test_hello_talks_and_listens(tmp_path):
    """With the shipped configuration of clients, to a daemon; it says what others say, and not what it says itself."""
    daemon = Running("--robot", "r1")
    try:
        daemon.wait_for("sendworthy ")
        shutil.copy(APPS / "hello.py", tmp_path)
        client = (APPS / "client.json5").read_text()
        (tmp_path / "client.json5").write_text(client.replace("tcp/127.0.0.1:7447", daemon.endpoint))
        output = tmp_path / "output"
        with output.open("w") as file, plain_session("client", connect=(daemon.endpoint,)) as other:
            buffered = os.environ | {"PYTHONUNBUFFERED": ""}  # else it may be ended between two parts of a line
            command = [sys.executable, "hello.py", "r1"]
            application = subprocess.Popen(command, cwd=tmp_path, stdout=file, env=buffered)
            try:
                heard = Heard(other, "robot/r1/battery")
                wait_until(lambda: heard.payloads, what="the charge")
                wait_until(lambda: other.put("robot/r2/battery", "full") or output.read_text(), what="what it prints")
            finally:
                application.terminate()
                application.wait(30)
        assert '{"charge": ' in heard.payloads[0]
        assert set(output.read_text().splitlines()) == {"robot/r2/battery full"}
    finally:
        daemon.end()


def test_the_node_of_ros_2_is_python():
    """There is no ROS 2 here to run it with; at least it says what it needs."""
    tree = ast.parse((APPS / "hello_ros2.py").read_text())
    imported = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported == {"rclpy.node", "std_msgs.msg"}
