"""Keys of a terminal, one by one as they are pressed; the terminal is as it was afterwards, whatever happens."""

import os
import re
import select
import signal
import termios
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

NAMES = {
    "\x1b[A": "up",
    "\x1b[B": "down",
    "\x1bOA": "up",
    "\x1bOB": "down",
    "\x1b[5~": "pageup",
    "\x1b[6~": "pagedown",
    "\x1b[H": "home",
    "\x1b[F": "end",
    "\x1bOH": "home",
    "\x1bOF": "end",
    "\x1b[1~": "home",
    "\x1b[4~": "end",
    "\x1b": "esc",
    "\r": "enter",
    "\n": "enter",
    "\t": "tab",
    "\x7f": "backspace",
    "\b": "backspace",
    "\x03": "ctrl-c",
}
_KEY = re.compile(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO[A-Z]|.", re.DOTALL)
ENDING = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


def keys_in(text: str) -> list[str]:
    """Return the keys that what was read stands for; sequences of no key that we know are none."""
    found = [NAMES.get(each, each) for each in _KEY.findall(text)]
    return [each for each in found if not each.startswith("\x1b") and (len(each) > 1 or each.isprintable())]


class Keyboard:
    """A terminal that gives each key at once, and can be woken."""

    def __init__(self, descriptor: int) -> None:
        self.ended = 0
        """The signal that asked the process to end."""
        self._descriptor = descriptor
        self._wakes, self._waker = os.pipe()
        os.set_blocking(self._waker, False)
        os.set_blocking(self._wakes, False)

    def wake(self) -> None:
        """Have `read` return now; any thread may call it."""
        try:
            os.write(self._waker, b"!")
        except BlockingIOError:
            return  # there are enough calls that were not heard yet

    def read(self) -> list[str] | None:
        """Wait for keys or a call, and return the keys; None when the terminal is gone, or the process has to end."""
        ready, _, _ = select.select([self._descriptor, self._wakes], [], [])
        if self.ended:
            return None
        if self._wakes in ready:
            os.read(self._wakes, 4096)
        if self._descriptor not in ready:
            return []
        try:
            read = os.read(self._descriptor, 1024)
        except OSError:
            return None
        return keys_in(read.decode(errors="ignore")) if read else None

    def end(self, number: int, _: FrameType | None) -> None:
        """A signal asks the process to end: the next `read` says so. Who asks twice does not wait for that.

        Raised at once, it left locks behind that were just being taken.
        """
        if self.ended:
            raise SystemExit(128 + number)
        self.ended = number

    def close(self) -> None:
        """Close what wakes it."""
        os.close(self._wakes)
        os.close(self._waker)


@contextmanager
def keyboard(descriptor: int) -> Iterator[Keyboard]:
    """Take over the terminal, and give it back. Where a signal asked for the end, SystemExit is raised then."""
    keys = Keyboard(descriptor)
    before = termios.tcgetattr(descriptor)
    signals = {number: signal.getsignal(number) for number in (*ENDING, signal.SIGWINCH, signal.SIGTSTP)}
    woken = signal.set_wakeup_fd(keys._waker)  # noqa: SLF001 - ours; a signal ends the wait
    try:
        for number in ENDING:
            signal.signal(number, keys.end)
        signal.signal(signal.SIGWINCH, _go_on)
        signal.signal(signal.SIGTSTP, signal.SIG_IGN)
        tty.setcbreak(descriptor)
        yield keys
    finally:
        signal.set_wakeup_fd(woken)
        for number, handler in signals.items():
            signal.signal(number, handler)
        try:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
        except termios.error:
            before = []  # the terminal is gone
        keys.close()
    if keys.ended:
        raise SystemExit(128 + keys.ended)


def _go_on(_: int, __: FrameType | None) -> None:
    """The size of the terminal changed: whoever waits for keys is woken."""
