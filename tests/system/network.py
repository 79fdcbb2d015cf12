"""Hosts that share a channel: network namespaces, joined by veth pairs to a bridge that is in a namespace too.

Nothing of it touches the network of the machine: addresses and the bridge exist only in the namespaces. Names carry
the process id of the run, so runs do not meet, and what a killed run left behind is swept by the next one.
"""

import copy
import json
import os
import re
import subprocess
import sys
from pathlib import Path

RADIO = "wlan0"
"""The interface of every host."""
ROOT = Path(__file__).parent.parent.parent
ROUTER = "10.77.0.254"
"""Where hosts of the channel find the router to the hosts beyond it."""
INSIDE = 'for each in {}; do mkdir -p "$0$each" && mount --rbind $each "$0$each"; done; exec chroot "$0" "$@"'
_PREFIX = "sendworthy"
_BRIDGE = "channel"


class Network:
    """The channel, and the hosts by name. Needs root. `close` removes all of it.

    `place` is an empty folder: there every process of a host finds temporary files that only it sees. Channels of
    different `name` can exist side by side and do not hear each other.
    """

    def __init__(self, place, name="air"):
        sweep()
        self._place = place
        self._air = f"{_PREFIX}-{os.getpid()}-{name}"
        self.hosts = {}
        ip("netns", "add", self._air)
        # A channel hears everything: no guesses about who wants which multicast group.
        ip("-n", self._air, "link", "add", "name", _BRIDGE, "type", "bridge", "mcast_snooping", "0")
        ip("-n", self._air, "link", "set", "dev", _BRIDGE, "up")

    def add(self, name):
        """Add a host."""
        host = Host(name, f"10.77.0.{len(self.hosts) + 1}", self._air, self._place)
        self.hosts[name] = host
        ip("netns", "add", host.namespace)
        ip("-n", self._air, "link", "add", "name", name, "type", "veth", "peer", "name", RADIO, "netns", host.namespace)
        ip("-n", self._air, "link", "set", "dev", name, "master", _BRIDGE, "up")
        ip("-n", host.namespace, "address", "add", f"{host.address}/24", "dev", RADIO)
        for interface in ("lo", RADIO):
            ip("-n", host.namespace, "link", "set", "dev", interface, "up")
        return host

    def add_beyond(self, name):
        """Add a host in another subnet, with a router between it and the channel: only unicast crosses."""
        host = Host(name, "10.78.0.1", self._air, self._place)
        self.hosts[name] = host
        ip("netns", "add", host.namespace)
        ip("-n", self._air, "link", "add", "name", name, "type", "veth", "peer", "name", RADIO, "netns", host.namespace)
        ip("-n", self._air, "address", "add", f"{ROUTER}/24", "dev", _BRIDGE)
        ip("-n", self._air, "address", "add", "10.78.0.254/24", "dev", name)
        ip("-n", self._air, "link", "set", "dev", name, "up")
        ip("netns", "exec", self._air, "sh", "-c", "echo 1 > /proc/sys/net/ipv4/ip_forward")
        ip("-n", host.namespace, "address", "add", f"{host.address}/24", "dev", RADIO)
        for interface in ("lo", RADIO):
            ip("-n", host.namespace, "link", "set", "dev", interface, "up")
        ip("-n", host.namespace, "route", "add", "default", "via", "10.78.0.254")
        for other in self.hosts.values():
            if other is not host:
                ip("-n", other.namespace, "route", "add", "10.78.0.0/24", "via", ROUTER)
        return host

    def close(self):
        """Remove everything, what was half made too."""
        for namespace in (*(host.namespace for host in self.hosts.values()), self._air):
            subprocess.run(["ip", "netns", "delete", namespace], check=False)


class Host:
    """One host: its namespace, and its place on the channel."""

    def __init__(self, name, address, air, place):
        self.name = name
        self.address = address
        self.namespace = f"{air}-{name}"
        self.clock = None
        """The wall clock of everything started from now on; None: the machine's."""
        self.python = sys.executable
        self.root = None
        """Where programs started from now on find their files; None: where the machine does."""
        self._air = air
        self._place = place

    def start(self, *command, **options):
        """Start a process on the host; the kernel kills it when this process dies."""
        return subprocess.Popen(["setpriv", "--pdeathsig", "KILL", *self._here(command)], cwd=ROOT, **options)

    def run(self, *command):
        """Run a command on the host to its end, and return it."""
        return subprocess.run(self._here(command), cwd=ROOT, capture_output=True, text=True, check=False, timeout=30)

    def within(self, namespace):
        """Return the same host as seen from another namespace on it."""
        inner = copy.copy(self)
        inner.namespace = namespace
        return inner

    def inside(self, root, python):
        """Return the same host with programs of another Debian, which see the folders of the test and these tests."""
        inner = copy.copy(self)
        inner.root, inner.python = root, python
        return inner

    def links(self):
        """The ports, ours and theirs, of the TCP connections with other hosts."""
        printed = self.run("ss", "-Htn", "state", "established").stdout
        ends = [[end.rpartition(":") for end in line.split()[2:4]] for line in printed.splitlines()]
        remote = [pair for pair in ends if "10.77." in pair[1][0] and self.address not in pair[1][0]]
        return [(int(ours[2]), int(theirs[2])) for ours, theirs in remote]

    def _here(self, command):
        # `ip netns exec` makes mounts private. Hosts share no files, so they must not share sockets that are files.
        own_files = 'mount -t tmpfs tmpfs "$0" && TMPDIR="$0" exec "$@"'
        clock = (
            () if self.clock is None else ("env", *(f"{name}={value}" for name, value in self.clock.environ.items()))
        )
        if self.root is not None:
            shared = (str(self._place.parent), str(ROOT / "tests"), "/dev", "/proc")
            command = ("sh", "-c", INSIDE.format(" ".join(shared)), str(self.root), *command)
        return ["ip", "netns", "exec", self.namespace, "sh", "-c", own_files, str(self._place), *clock, *command]

    def sent(self):
        """How many bytes went on the air so far, with the headers of all layers down to Ethernet."""
        (link,) = json.loads(ip("-n", self.namespace, "-s", "-j", "link", "show", RADIO))
        return link["stats64"]["tx"]["bytes"]

    def radio(self, state):
        """Switch the radio "up" or "down"."""
        ip("-n", self.namespace, "link", "set", "dev", RADIO, state)

    def port(self, state):
        """Put the host's place on the channel "up" or "down": the radio stays on and finds nobody."""
        ip("-n", self._air, "link", "set", "dev", self.name, state)

    def range(self, *, within):
        """Bring the host into the range of the others or out of it: out there everything sent is lost."""
        state = "3" if within else "0"  # of a bridge's port: forwarding, disabled
        command = ("bridge", "-n", self._air, "link", "set", "dev", self.name, "state", state)
        subprocess.run(command, check=True)

    def lose_ipv6(self):
        """Let the host be one without IPv6."""
        self.run("sh", "-c", "echo 1 > /proc/sys/net/ipv6/conf/all/disable_ipv6")

    def slow_down(self, rate):
        """Let the radio send no faster than `rate`, with half a second of queue."""
        limit = ("tbf", "rate", rate, "burst", "4kb", "latency", "500ms")
        self._tc("replace", "dev", RADIO, "root", *limit)

    def slow_reception(self, rate):
        """Let the channel bring no more than `rate` to the host: who sends to it is slowed down, others are not."""
        limit = ("tbf", "rate", rate, "burst", "4kb", "latency", "500ms")
        subprocess.run(["tc", "-n", self._air, "qdisc", "replace", "dev", self.name, "root", *limit], check=True)

    def lose(self, percent):
        """Lose so many of the packets that the radio receives, at random."""
        self.run("nft", "delete", "table", "netdev", "loss")
        if percent:
            hook = f"type filter hook ingress device {RADIO} priority 0;"
            rules = f"table netdev loss {{ chain lose {{ {hook} numgen random mod 100 < {percent} drop; }}; }};"
            done = self.run("nft", rules)
            assert done.returncode == 0, done.stderr

    def backlog(self):
        """What waits at the radio [B]."""
        return sum(queue.get("backlog", 0) for queue in json.loads(self._tc("-s", "-j", "show", "dev", RADIO)))

    def _tc(self, *arguments):
        flags = [flag for flag in arguments if flag.startswith("-")]
        rest = arguments[len(flags) :]
        command = ["tc", "-n", self.namespace, *flags, "qdisc", *rest]
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def ip(*arguments):
    """Run `ip`; return what it prints."""
    return subprocess.run(["ip", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def sweep():
    """Remove the namespaces of runs that are no more."""
    for name in re.findall(rf"^{_PREFIX}-\d+-\S+", ip("netns", "list"), re.MULTILINE):
        if not Path("/proc", name.split("-")[1]).exists():
            ip("netns", "delete", name)
