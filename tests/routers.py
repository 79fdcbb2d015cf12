"""Zenoh routers as processes of their own, as an installation runs zenohd."""

import json
import subprocess
import sys

ROUTER = """
import sys, zenoh
zenoh.init_log_from_env_or("error")
with zenoh.open(zenoh.Config.from_json5(sys.argv[1])):
    print("ready", flush=True)
    sys.stdin.read()
"""


def here(*command, **options):
    """Start a process on this host."""
    return subprocess.Popen(command, **options)


class Router:
    """A router that listens on `endpoint` and dials `connect`; `start` starts its process somewhere else."""

    def __init__(self, endpoint, *connect, start=here):
        self._start = start
        self.endpoint = endpoint
        self._options = {
            "mode": "router",
            "listen": {"endpoints": [endpoint]},
            "connect": {
                "endpoints": list(connect),
                "timeout_ms": -1,
                "exit_on_failure": False,
                "retry": {"period_init_ms": 50, "period_max_ms": 50},
            },
            "scouting": {"multicast": {"enabled": False}},
        }
        self.start()

    def start(self):
        """Start it; it has been killed or was never there."""
        command = (sys.executable, "-c", ROUTER, json.dumps(self._options))
        self._process = self._start(*command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout.readline() == "ready\n"

    def kill(self):
        """End it as a power cut does."""
        self._process.kill()
        self._process.communicate()
