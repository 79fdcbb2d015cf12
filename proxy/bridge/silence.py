"""Which robots fell silent: their links are ended.

Zenoh gives a link up when nothing was read from it for a lease. On a busy machine it may be the reader that had no
time, or the writer at the other end. The kernels acknowledge what arrives whatever their processes do: who does not do
that for a while is gone, or out of reach. So Zenoh's lease can be long, and links that are idle are probed by the
kernels too: with 10 peers it took a third of what an idle daemon does to have Zenoh say on each, twice a second, that
it is alive.
"""

import ctypes
import logging
import math
import socket
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import zenoh

from proxy.bridge.sockets import Sockets, libc, tcp_info
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)

_INFO = struct.Struct("@3xB20xI16xI8xI60xQ")
"""What matters in `tcp_info` of <linux/tcp.h>: probes without an answer, segments on their way, time since data was
sent and since anything came [ms], bytes that arrived. Where the radio is off, nothing gets on its way: the kernel
probes instead."""


def longest_silence(zenoh_options: Mapping[str, Any]) -> float:
    """How long a robot may be silent [s]: who configures Zenoh's lease means that."""
    lease: float | None = zenoh_options.get("transport", {}).get("link", {}).get("tx", {}).get("lease")
    return TUNING.silent_robot if lease is None else lease / 1000


class Answers(NamedTuple):
    """What the kernel knows of the other end of a link."""

    awaited: float | None
    """For how long at least it has not acknowledged what was sent, or could not be [s]; None: it has nothing to."""
    acknowledged: int
    """What it acknowledged so far [B]."""
    heard: float
    """How long ago anything came [s]: that may be long where nothing was sent for long."""


class Silence:
    """Ends links of `session` whose other end is silent for `longest` [s]."""

    def __init__(self, session: zenoh.Session, longest: float = TUNING.silent_robot) -> None:
        self._sockets = Sockets(session)
        self._longest = longest
        self._idle = max(1, int(TUNING.probing * longest))
        """The kernel probes links that are idle for so long, and again after as long [s]; it takes whole ones."""
        self._last: dict[tuple[str, int], tuple[float, Answers]] = {}
        """Since when each link is silent [s], and what was known at the last look."""

    def check(self, now: float) -> float:
        """Look at all links; return when the next of them will have been silent for too long [s]."""
        self._sockets.refresh()
        found = {(zid, number): answers for zid, number in self._sockets.ends if (answers := self._answers(number))}
        for _, number in found.keys() - self._last.keys():
            self._have_probed(number)
        self._last = {
            link: (silent_since(now, *self._last.get(link, (now, this)), this), this) for link, this in found.items()
        }
        due = math.inf
        for (zid, number), (since, answers) in self._last.items():
            if now < since + self._longest:
                due = due if answers.awaited is None else min(due, since + self._longest)
            elif self._sockets.end(number):
                log.debug("nothing was heard from %s for %.1f s: its link is ended", zid, now - since)
        return due

    def _have_probed(self, number: int) -> None:
        for level, option, value in (
            (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
            (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, self._idle),
            (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, self._idle),
        ):
            libc.setsockopt(number, level, option, ctypes.byref(ctypes.c_int(value)), ctypes.sizeof(ctypes.c_int))

    def _answers(self, number: int) -> Answers | None:
        """Return what is known of a link; None when it is gone."""
        info = tcp_info(number)
        if info is None:
            return None
        probes, unacked, sent, heard, acknowledged = _INFO.unpack_from(info)
        awaited = sent / 1000 if unacked else max(0.0, heard / 1000 - self._idle) if probes else None
        return Answers(awaited, acknowledged, heard / 1000)


def silent_since(now: float, before: float, last: Answers, this: Answers) -> float:
    """Since when nothing came although it should [s]; `before` is what that was at the last look."""
    if this.awaited is None:
        return now
    if last.awaited is None:
        return max(before, now - min(this.awaited, this.heard))
    return max(before, now - this.heard) if last.acknowledged == this.acknowledged else now
