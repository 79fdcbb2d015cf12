"""The medium as the kernel makes it (`--netns`, needs root): a network namespace for each robot, and one queue for all.

Robots and the operator, who stays on the machine itself, are joined by a bridge in a namespace of its own. What comes
in at any of its ports goes through one interface (ifb) first, whose token bucket (tbf) is what the channel carries;
netem delays and loses packets there. Names carry the process id, so that demos side by side do not meet.
"""

import json
import os
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from types import TracebackType
from typing import Self

from studies.demo.air import Air, AirError
from studies.demo.layout import Node, pairs
from studies.demo.processes import DemoError

SUBNET = "198.18.19"
"""For measurements of networks (RFC 2544): no network of a machine has these addresses."""
PREFIX = "sendworthy-demo"
BURST = 16 * 1024
"""What the token bucket may catch up [B]."""
QUEUE = 64 * 1024
"""What waits at the channel at most; more is lost, and TCP sends it again [B]."""
_IFB, _BRIDGE = "air", "channel"
_TOOLS = "/usr/sbin:/sbin:/usr/bin:/bin"


class Namespaces:
    """The channel, while in a `with` statement, which removes all of it. Raises DemoError where that cannot be."""

    def __init__(self, air: Air) -> None:
        if os.geteuid():
            raise DemoError("--netns: network namespaces need root")
        for tool in ("ip", "tc"):
            if shutil.which(tool, path=_TOOLS) is None:
                raise DemoError(f"--netns: needs the program {tool} (Debian: iproute2)")
        self._air = f"{PREFIX}-{os.getpid()}"
        self._device = f"demo{os.getpid()}"
        self._namespaces: list[str] = []
        self._in_force = replace(air, latency=0.0, loss=0.0)
        self._wanted = air

    def __enter__(self) -> Self:
        try:
            self._make()
        except BaseException:
            self._remove()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._remove()

    def add(self, nodes: Sequence[Node]) -> tuple[Node, ...]:
        """Give every node its place; the operator, number 0, stays on the machine."""
        return tuple(self._add(node) for node in nodes)

    def dials(self, nodes: tuple[Node, ...]) -> dict[str, list[str]]:
        """Return which endpoints each node dials."""
        found: dict[str, list[str]] = {node.name: [] for node in nodes}
        for dialer, target in pairs(nodes):
            found[dialer.name].append(target.mesh_endpoint)
        return found

    def change(self, air: Air) -> None:
        """Make the channel so. Raises AirError for what this kernel cannot, and then leaves it as it was."""
        self._set_rate(air)
        if (air.latency, air.loss) != (self._in_force.latency, self._in_force.loss):
            netem = ["netem", "delay", f"{1e3 * air.latency:.3f}ms", "loss", f"{100 * air.loss:.3f}%", "limit", "10000"]
            try:
                _tc(self._air, "qdisc", "replace", "dev", _IFB, "parent", "1:1", "handle", "10:", *netem)
            except DemoError as error:
                self._set_rate(self._in_force)
                key = "latency" if air.latency != self._in_force.latency else "loss"
                raise AirError(f"{key}: the kernel's netem is needed for that, and refused: {error}") from None
        self._in_force = air

    def _set_rate(self, air: Air) -> None:
        rate = ["rate", f"{8 * air.limit:.0f}bit", "burst", str(BURST), "limit", str(QUEUE)]
        _tc(self._air, "qdisc", "replace", "dev", _IFB, "root", "handle", "1:", "tbf", *rate)

    def carried(self) -> int:
        """Return how many bytes went over the channel so far, with the headers of all layers."""
        found = json.loads(_tc(self._air, "-s", "-j", "qdisc", "show", "dev", _IFB))
        return int(next(each["bytes"] for each in found if each.get("root")))

    def _make(self) -> None:
        _ip("netns", "add", self._air)
        self._namespaces.append(self._air)
        _ip("-n", self._air, "link", "add", "name", _BRIDGE, "type", "bridge")
        _ip("-n", self._air, "link", "add", "name", _IFB, "type", "ifb")
        for device in (_BRIDGE, _IFB):
            _ip("-n", self._air, "link", "set", "dev", device, "up")
        try:
            self.change(self._wanted)
        except AirError as error:
            raise DemoError(f"--netns: {error}") from None

    def _add(self, node: Node) -> Node:
        port, namespace = f"port{node.number}", None
        if node.number == 0:
            device = self._device
            inside, place = list[str](), "1"
        else:
            device, namespace = "wlan0", f"{self._air}-{node.name}"
            _ip("netns", "add", namespace)
            self._namespaces.append(namespace)
            inside, place = ["-n", namespace], namespace
            _ip(*inside, "link", "set", "dev", "lo", "up")
        pair = ["name", port, "type", "veth", "peer", "name", device, "netns", place]
        _ip("-n", self._air, "link", "add", *pair)
        host = f"{SUBNET}.{node.number + 1}"
        _ip(*inside, "address", "add", f"{host}/24", "dev", device)
        _ip(*inside, "link", "set", "dev", device, "up")
        _ip("-n", self._air, "link", "set", "dev", port, "master", _BRIDGE, "up")
        _tc(self._air, "qdisc", "add", "dev", port, "handle", "ffff:", "ingress")
        redirect = ["match", "u32", "0", "0", "action", "mirred", "egress", "redirect", "dev", _IFB]
        _tc(self._air, "filter", "add", "dev", port, "parent", "ffff:", "protocol", "all", "u32", *redirect)
        return replace(node, host=host, namespace=namespace)

    def _remove(self) -> None:
        # The pair that reaches the machine goes at once; what is in namespaces goes with them, a moment later.
        if self._namespaces:
            subprocess.run([_tool("ip"), "link", "delete", "dev", self._device], capture_output=True, check=False)
        for namespace in reversed(self._namespaces):
            subprocess.run([_tool("ip"), "netns", "delete", namespace], check=False)
        self._namespaces.clear()


def _ip(*arguments: str) -> str:
    return _run("ip", *arguments)


def _tc(namespace: str, *arguments: str) -> str:
    return _run("tc", "-n", namespace, *arguments)


def _run(tool: str, *arguments: str) -> str:
    done = subprocess.run([_tool(tool), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise DemoError(f"{tool} {' '.join(arguments)}: {done.stderr.strip() or done.returncode}")
    return done.stdout


def _tool(name: str) -> str:
    return shutil.which(name, path=_TOOLS) or name
