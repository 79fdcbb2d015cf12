"""Which of the endpoints to dial are linked, and one line in the log for each that is not."""

import logging
import re
import socket
import threading
from collections.abc import Iterable
from typing import Literal

import zenoh

from proxy.bridge.sockets import links_of
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)


class Links:
    """Watches the links of the session of one side. Zenoh itself keeps dialling what is missing."""

    def __init__(
        self, session: zenoh.Session, connect: Iterable[str], started: float, side: Literal["app", "mesh"] = "mesh"
    ) -> None:
        self._session = session
        self._side = side
        self._missing = dict.fromkeys(connect, started)
        self._locators = {endpoint: frozenset({_locator(endpoint)}) for endpoint in self._missing}
        """What each endpoint may show up as in a link."""
        self._resolving = False
        self._warned: set[str] = set()
        self._next = started

    def check(self, now: float) -> None:
        """Say once what is missed after its grace, and when it is there after all."""
        if now < self._next or not self._missing:
            return
        links = links_of(self._session)
        linked = {link.dst for link in links}
        # Two robots that dial each other keep one link: not every endpoint shows up, but every peer is there.
        robots = len({str(link.zid) for link in links})
        complete = self._side == "mesh" and robots >= len(self._missing)
        self._next = now + (TUNING.linked_check if complete else TUNING.missing_check)
        if linked and not complete and not self._resolving:
            self._resolving = True
            threading.Thread(target=self._resolve, name="resolver", daemon=True).start()
        for endpoint, since in self._missing.items():
            if complete or linked & self._locators[endpoint]:
                if endpoint in self._warned:
                    log.info("%s.connect: %s is linked now", self._side, endpoint)
                self._warned.discard(endpoint)
            elif endpoint not in self._warned and now - since > TUNING.link_grace:
                self._warned.add(endpoint)
                log.warning("%s.connect: no link to %s yet; still trying", self._side, endpoint)

    def warnings(self) -> list[str]:
        """Name what is missed longer than its grace. From any thread."""
        return [f"{self._side}.connect: no link to {endpoint}; still trying" for endpoint in sorted(self._warned)]

    def describe(self) -> list[dict[str, str]]:
        """Return the links there are, for the status."""
        return [{"zid": str(link.zid), "source": link.src, "destination": link.dst} for link in links_of(self._session)]

    def _resolve(self) -> None:
        """Look names up: where no name server is in reach each takes seconds, and all that is mirrored would wait."""
        for endpoint in self._missing:
            self._locators[endpoint] = _resolved(endpoint)
        self._resolving = False


def _locator(endpoint: str) -> str:
    return re.split("[#?]", endpoint, maxsplit=1)[0]


def _resolved(endpoint: str) -> frozenset[str]:
    """Return the locators an endpoint may show up as in a link."""
    locator = _locator(endpoint)
    protocol, _, address = locator.partition("/")
    host, _, port = address.rpartition(":")
    try:
        found = socket.getaddrinfo(host.strip("[]"), port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return frozenset({locator})
    names = {f"[{where[0]}]" if family == socket.AF_INET6 else where[0] for family, *_, where in found}
    return frozenset({locator, *(f"{protocol}/{name}:{port}" for name in names)})
