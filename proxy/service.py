"""What systemd wants to hear from a service (Type=notify): ready, reloading, stopping, and that it is alive.

Source: sd_notify(3), sd_watchdog_enabled(3).
"""

import logging
import os
import socket
from collections.abc import Mapping

from proxy import clock

log = logging.getLogger(__name__)


class Service:
    """Tells systemd; where nobody listens it does nothing. `environ` is the environment of the process."""

    def __init__(self, environ: Mapping[str, str]) -> None:
        self._address = environ.get("NOTIFY_SOCKET", "")
        # Opened once: where there is no descriptor left systemd would not hear that we are alive, and would end us.
        kind = socket.SOCK_DGRAM | socket.SOCK_CLOEXEC
        self._speaker = socket.socket(socket.AF_UNIX, kind) if self._address else None
        self.watchdog = _watchdog(environ) if self._address else None
        """We must say at least this often that we are alive [s]; None: we need not."""

    def ready(self, status: str) -> None:
        """Everything works; `status` is one line for `systemctl status`."""
        self._tell("READY=1", f"STATUS={status}")

    def reloading(self) -> None:
        """Files are read anew; `ready` follows."""
        self._tell("RELOADING=1", f"MONOTONIC_USEC={int(clock.monotonic() * 1e6)}")

    def stopping(self) -> None:
        """The end is near."""
        self._tell("STOPPING=1")

    def alive(self) -> None:
        """Feed the watchdog."""
        self._tell("WATCHDOG=1")

    def close(self) -> None:
        """Tell nothing more."""
        if self._speaker is not None:
            self._speaker.close()
            self._speaker = None

    def _tell(self, *lines: str) -> None:
        if self._speaker is None:
            return
        # An abstract address is written with "@" in place of the zero byte.
        address = "\0" + self._address[1:] if self._address.startswith("@") else self._address
        try:
            self._speaker.sendto("\n".join(lines).encode(errors="replace"), socket.MSG_DONTWAIT, address)
        except OSError as error:
            log.warning("systemd does not hear us at %s: %s", self._address, error.strerror)


def _watchdog(environ: Mapping[str, str]) -> float | None:
    """Return the time after which systemd gives up on us [s]; None when it waits for ever or for somebody else."""
    if environ.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    try:
        microseconds = int(environ.get("WATCHDOG_USEC", "0"))
    except ValueError:
        return None
    return microseconds * 1e-6 if microseconds > 0 else None
