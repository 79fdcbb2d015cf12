"""Looks for applications of this robot that can be reached around the daemon."""

import json
import re
import socket
import threading
from collections.abc import Iterable, Mapping
from typing import Any

import zenoh

from proxy.bridge.tuning import TUNING

SCOUTING_GROUP = "224.0.0.224:7446"
"""Where Zenoh's nodes look for each other by default."""
SIGN = ("127.0.0.1", 7446)
"""Where the rules of `deploy/apps/radio.nft` let nothing be sent: so we know that they are in force."""

CURE = "give it the configuration deploy/apps/client.json5 or another of the drop-ins in docs/guides/applications.md"


class Lookout:
    """Scouts as applications do, on a thread of its own, but for this host alone: nothing goes on the air.

    `interface` is that of the radio. `ours` are the sessions of this daemon.
    """

    def __init__(self, interface: str, ours: Iterable[str], group: str = SCOUTING_GROUP) -> None:
        multicast = {"ttl": 0, "interface": interface, "address": group}
        self._config = zenoh.Config.from_json5(json.dumps({"scouting": {"multicast": multicast}}))
        self._ours = frozenset(ours)
        self._found: dict[str, str] = {}
        self.looks = 0
        """How often it has looked so far."""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="lookout", daemon=True)

    def start(self) -> None:
        """Start looking."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop looking; wait for it at most `timeout` [s]."""
        self._stop.set()
        self._thread.join(timeout)

    def warnings(self) -> list[str]:
        """Say who answers others over the radio, for the status."""
        found = self._found
        if not found or guarded():
            return []
        return [
            f"{who} on this robot answers everybody on the radio, at {locator}, around the daemon: {CURE}"
            for who, locator in sorted(found.items())
        ]

    def look(self) -> None:
        """Scout once."""
        found: dict[str, str] = {}

        def take(hello: zenoh.Hello) -> None:
            locator = next(filter(on_this_host, hello.locators), None)
            if locator is not None and str(hello.zid) not in self._ours:
                found[f"the Zenoh {str(hello.whatami).lower()} {hello.zid}"] = locator

        # Its stubs promise neither this kind of handler nor what `stop` returns.
        scout: Any = zenoh.scout(zenoh.handlers.Callback(take, indirect=False), "peer|router", self._config)  # type: ignore[arg-type]
        self._stop.wait(TUNING.lookout_listen)
        scout.stop()
        self._found = found
        self.looks += 1

    def _run(self) -> None:
        while not self._stop.is_set():
            self.look()
            self._stop.wait(TUNING.lookout_interval)


def around(app: zenoh.Session, mesh: zenoh.Session, others: Mapping[str, str]) -> list[str]:
    """Say which applications have a link to our mesh session, for the status.

    `others` are sessions of other robots' applications, with the names of the robots.
    """
    own = {str(link.zid) for link in app.info.links()}
    found = []
    for link in mesh.info.links():
        zid = str(link.zid)
        robot = "this robot" if zid in own else f"robot {others[zid]}" if zid in others else None
        if robot is not None:
            found.append(
                f"the application {zid} of {robot} is on the mesh itself, around its daemon, at {link.dst}: {CURE}"
            )
    return found


def guarded() -> bool:
    """Whether `deploy/apps/radio.nft` is in force: what scouts cannot go past."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.sendto(b"", SIGN)
        except PermissionError:
            return True
        except OSError:
            pass
        return False


def on_this_host(locator: str) -> bool:
    """Whether a locator is an address of this host that others can reach."""
    found = re.fullmatch(r"\w+/\[?([^\]]+?)\]?:\d+", re.split("[#?]", locator, maxsplit=1)[0])
    if found is None:
        return False
    try:
        family, _, _, _, place = socket.getaddrinfo(found[1], 0, type=socket.SOCK_DGRAM, flags=socket.AI_NUMERICHOST)[0]
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.bind(place)
    except OSError:
        return False
    return not found[1].startswith(("127.", "::1"))
