"""Puts lines on a terminal with rich, which comes with the extra `top`."""

import os
import sys
import threading
from collections.abc import Sequence

from rich.console import Console, ConsoleDimensions
from rich.live import Live
from rich.text import Text

from proxy.top.asking import Asking
from proxy.top.frames import Line, frame
from proxy.top.keyboard import Keyboard, keyboard
from proxy.top.view import View

WIDTH = 160
"""How wide it is where there is no terminal."""
USUAL = os.terminal_size((80, 24))
"""How large a terminal is taken to be that does not say, as a serial console."""


def once(endpoints: Sequence[str], view: View, interval: float) -> bool:
    """Print one picture, of what happened within an interval; return whether there was what is wanted."""
    news = threading.Semaphore(0)
    asking = Asking(endpoints, interval, news.release)
    asking.start()
    try:
        while not asking.ready:
            news.acquire()
    finally:
        asking.stop()
    scene = asking.scene
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = WIDTH
    with console.capture() as drawn:  # rich would end the process where nobody reads on
        for line in frame(scene, view, console.width)[:-1]:
            console.print(_text(line), no_wrap=True)
    print(drawn.get(), end="", flush=True)
    return view.found


def live(endpoints: Sequence[str], view: View, interval: float) -> None:
    """Show what daemons say until somebody quits."""
    with keyboard(sys.stdin.fileno()) as keys:
        asking = Asking(endpoints, interval, keys.wake)
        try:
            with Live(screen=True, auto_refresh=False, console=Console(highlight=False)) as display:
                asking.start()
                _run(display, asking, keys, view)
        finally:
            asking.stop()


def _run(display: Live, asking: Asking, keys: Keyboard, view: View) -> None:
    while not view.done:
        # As it is now: rich would believe an environment that says how large the terminal was.
        size = os.get_terminal_size(sys.stdout.fileno())
        columns, rows = size.columns or USUAL.columns, size.lines or USUAL.lines
        display.console.size = ConsoleDimensions(columns, rows)
        lines = frame(asking.scene, view, columns, rows)
        display.update(Text("\n", end="").join(map(_text, lines)), refresh=True)
        pressed = keys.read()
        if pressed is None:
            return
        for key in pressed:
            view.press(key)


def _text(line: Line) -> Text:
    return Text(line.text, style=line.style, no_wrap=True, overflow="crop", end="")
