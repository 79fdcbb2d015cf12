"""The constants of the page, each with why it is what it is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PageTuning:
    """How much may be shown, kept and sent, and how often it is looked."""

    history: float = 300.0
    """So much of the past is kept for who opens the page [s]."""
    tiles: int = 64
    """Cameras that are shown at most."""
    image_bytes: int = 4 * 1024 * 1024
    """Larger images are not shown [B]: of each camera each viewer may hold one that waits and one on its way."""
    viewers: int = 16
    """Pages that are open at once, at most; each takes what its network carries."""
    head: float = 5.0
    """Who connects asks something within this time, and again after an answer, or is cut off [s]: as long as uvicorn
    keeps a connection that says nothing after one."""
    silent: float = 15.0
    """A browser takes some of what is sent within this time, or is cut off [s]: a radio may well be gone for ten."""
    rate_window: float = 3.0
    """How often frames come is counted over so long [s]."""
    count_window: float = 10.0
    """What becomes of samples is counted over so long [s]: digests of who has little to tell are seconds apart."""
    look: float = 1.0
    """Whether specs and the demo are still what they were is looked at so often [s]."""
    body_bytes: int = 2 * 1024 * 1024
    """What a browser sends may be so large [B]: all specs that can be pushed, as JSON."""
    marked: float = 2.0
    """A sample worth so many times the usual one of its type is marked: with `1 + 10 * red` from 10 % red on."""
    linger: float = 1.0
    """A browser that does not read may hold up the end for so long [s]."""


TUNING = PageTuning()
