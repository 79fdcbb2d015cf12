"""The demo in network namespaces: the kernel is the medium."""

import json
import subprocess

import pytest

from proxy.cli import main

pytestmark = pytest.mark.system


def test_the_kernel_carries_no_more_than_it_is_told(tmp_path):
    """Robots reach the operator, all they say goes over the channel, and nothing is left behind."""
    before = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True).stdout
    files = [str(tmp_path / name) for name in ("figures.json", "picture.png")]
    arguments = ["demo", "--netns", "--robots", "2", "--seconds", "6", "--rate", "1.5e6"]
    assert main([*arguments, "--json", files[0], "--picture", files[1]]) == 0
    for way in json.loads((tmp_path / "figures.json").read_text()).values():
        # The counters are read once a second, from before the start on.
        assert 0 < way["received_bytes"] <= way["medium_bytes"] <= 1.1 * 8.0 * 1.5e6 / 8
    after = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True).stdout
    assert [line for line in after.splitlines() if "sendworthy-demo" in line and line not in before] == []
