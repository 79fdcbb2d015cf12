"""Wall clocks of robots that disagree: nothing depends on them but timestamps, which is what people look at."""

from collections.abc import Iterable

from proxy.core.interface.commands import Command, Notice
from proxy.core.view.peer import Peer
from proxy.core.view.view import SharedView

APART = 0.05
"""Wall clocks further apart than this are worth a warning [s]."""
TOGETHER = 0.04
"""Those not further apart than this no more [s]."""


class WallClocks:
    """Says once when the clock of another robot and ours part, and when they are together again."""

    def __init__(self, view: SharedView) -> None:
        self._view = view

    def compare(self, now: float, peers: Iterable[Peer]) -> list[Command]:
        """Look at the clocks of `peers` anew; return what is worth a line in the log."""
        return [notice for peer in peers for notice in self._compared(peer, now)]

    def _compared(self, peer: Peer, now: float) -> list[Command]:
        ahead = wall_ahead(self._view, peer)
        if ahead is None or (peer.apart is None and abs(ahead) <= APART):
            return []
        uncertainty = peer.offset.uncertainty(now)
        if uncertainty > TOGETHER:
            return []
        was, wrong = peer.apart is not None, abs(ahead) - uncertainty > (TOGETHER if peer.apart else APART)
        peer.apart = ahead if wrong else None
        if wrong == was:
            return []
        ours = self._view.settings.robot
        text = parted(ours, peer.robot, ahead) if wrong else f"the clocks of {peer.robot} and {ours} agree again"
        return [Notice("warning" if wrong else "info", text)]


def wall_ahead(view: SharedView, peer: Peer) -> float | None:
    """Return what a robot's wall clock shows more than ours [s]; None while unknown."""
    if peer.wall_offset is None or not peer.offset.known:
        return None
    return peer.wall_offset - view.wall_offset - peer.offset.offset


def clock_warnings(view: SharedView) -> list[str]:
    """Name every robot whose wall clock shows another time than ours."""
    ours = view.settings.robot
    return [parted(ours, peer.robot, peer.apart) for peer in view.peers.values() if peer.apart is not None]


def parted(ours: str, theirs: str, ahead: float) -> str:
    """Say that a robot's clock shows so much more than ours [s]."""
    way = "ahead of" if ahead > 0.0 else "behind"
    return f"the clock of {theirs} is {abs(ahead):.3f} s {way} that of {ours}: timestamps cannot be compared"
