"""Links that are given up are closed at once.

Zenoh has the kernel wait for up to 10 s when it closes a socket that still holds something, as that of a lost link
does, and the thread of its runtime that closes it waits, too. All sessions of a process share these threads: with four
of them and six lost robots, the apps of this robot heard nothing from each other for 4 s. Without that wait the kernel
sends in the background what it still holds.
"""

import ctypes
import socket
import struct

import zenoh

from proxy.bridge.sockets import Sockets, libc

_OFF = struct.pack("@ii", 0, 0)
"""`struct linger` of <sys/socket.h>: not at all."""


class Linger:
    """Takes care of all links of `session`."""

    def __init__(self, session: zenoh.Session) -> None:
        self._sockets = Sockets(session)

    def check(self, now: float) -> None:  # noqa: ARG002 - as all that looks at links is called
        """Take care of those that are new."""
        if not self._sockets.refresh():
            return
        for _, number in self._sockets.ends:
            libc.setsockopt(number, socket.SOL_SOCKET, socket.SO_LINGER, ctypes.c_char_p(_OFF), len(_OFF))
