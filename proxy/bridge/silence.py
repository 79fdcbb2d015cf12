"""Which robots fell silent: their links are ended.

Zenoh gives a link up when nothing was read from it for a lease. On a busy machine it may be the reader that had no
time, or the writer at the other end. The kernels acknowledge what arrives whatever their processes do: who does not do
that for a while is gone, or out of reach. So Zenoh's lease can be long.
"""

import logging
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import zenoh

from proxy.bridge.sockets import Sockets, tcp_info
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)

_INFO = struct.Struct("@3xB20xI28xI60xQ")
"""What matters in `tcp_info` of <linux/tcp.h>: probes without an answer, segments on their way, time since anything
came [ms], bytes that arrived. Where the radio is off, nothing gets on its way: the kernel probes instead."""


def longest_silence(zenoh_options: Mapping[str, Any]) -> float:
    """How long a robot may be silent [s]: who configures Zenoh's lease means that."""
    lease: float | None = zenoh_options.get("transport", {}).get("link", {}).get("tx", {}).get("lease")
    return TUNING.silent_robot if lease is None else lease / 1000


class Answers(NamedTuple):
    """What the kernel knows of the other end of a link."""

    awaited: bool
    """Whether something was sent, or could not be, that it did not acknowledge."""
    acknowledged: int
    """What it acknowledged so far [B]."""
    heard: float
    """How long ago anything came [s]: that may be long where nothing was sent for long."""


class Silence:
    """Ends links of `session` whose other end is silent for `longest` [s]."""

    def __init__(self, session: zenoh.Session, longest: float = TUNING.silent_robot) -> None:
        self._sockets = Sockets(session)
        self._longest = longest
        self._last: dict[tuple[str, int], tuple[float, Answers]] = {}
        """Since when each link is silent [s], and what was known at the last look."""

    def check(self, now: float) -> None:
        """Look at all links."""
        self._sockets.refresh()
        found = {(zid, number): answers for zid, number in self._sockets.ends if (answers := _answers(number))}
        self._last = {
            link: (silent_since(now, *self._last.get(link, (now, this)), this), this) for link, this in found.items()
        }
        for (zid, number), (since, _) in self._last.items():
            if now - since >= self._longest and self._sockets.end(number):
                log.debug("nothing was heard from %s for %.1f s: its link is ended", zid, now - since)


def silent_since(now: float, before: float, last: Answers, this: Answers) -> float:
    """Since when nothing came although it should [s]; `before` is what that was at the last look."""
    same = last.awaited and this.awaited and last.acknowledged == this.acknowledged
    return max(before, now - this.heard) if same else now


def _answers(number: int) -> Answers | None:
    """Return what is known of a link; None when it is gone."""
    info = tcp_info(number)
    if info is None:
        return None
    probes, unacked, heard, acknowledged = _INFO.unpack_from(info)
    return Answers(unacked > 0 or probes > 0, acknowledged, heard / 1000)
