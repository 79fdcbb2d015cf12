"""Wall clocks of robots: ours, what it tells of the offsets to others, and which clocks disagree."""

from collections.abc import Iterable, Mapping

from proxy.core.interface.commands import Command, Notice
from proxy.core.model.settings import CoreSettings
from proxy.core.transit.tuning import TUNING as TRANSIT
from proxy.core.view.peer import Peer
from proxy.core.view.tuning import TUNING


class WallClocks:
    """Our wall clock beside those of the others; says once when two part, and when they are together again."""

    def __init__(self, settings: CoreSettings, peers: Mapping[str, Peer]) -> None:
        self._robot = settings.robot
        self._peers = peers
        self.offset = settings.wall_offset
        """Our wall clock minus our monotonic clock [s]."""
        self.error = 0.0
        """What our wall clock is wrong by at most [s]; 0.0: nobody knows."""
        self._apart: dict[str, float] = {}
        """Wall clocks of others minus ours [s], by tag, where that is worth a warning."""

    def set(self, offset: float, error: float) -> None:
        """Our wall clock shows so much more than the monotonic one, wrong by `error` at most; 0.0: unknown [s]."""
        if abs(offset - self.offset) > TRANSIT.wall_clock_set:
            for peer in self._peers.values():
                peer.offset.unshown()
        self.offset, self.error = offset, error

    def bound(self, now: float, peer: Peer) -> None:
        """The state of a peer tells of its wall clock now: that bounds its clock offset where both clocks are right."""
        if self.error and peer.clock_error and peer.inbound.wall_offset is not None:
            error = self.error + peer.clock_error + TUNING.untold_clock_step
            peer.offset.shown(now, peer.inbound.wall_offset - self.offset, error)

    def forget(self, name: str) -> None:
        """The robot with this tag left."""
        self._apart.pop(name, None)

    def ahead(self, peer: Peer) -> float | None:
        """Return what a robot's wall clock shows more than ours [s]; None while unknown."""
        if peer.inbound.wall_offset is None or not peer.offset.known:
            return None
        return peer.inbound.wall_offset - self.offset - peer.offset.offset

    def compare(self, now: float, peers: Iterable[Peer]) -> list[Command]:
        """Look at the clocks of `peers` anew; return what is worth a line in the log."""
        return [notice for peer in peers for notice in self._compared(peer, now)]

    def warnings(self) -> list[str]:
        """Name every robot whose wall clock shows another time than ours."""
        apart = ((peer, self._apart.get(name)) for name, peer in self._peers.items())
        return [self._parted(peer, ahead) for peer, ahead in apart if ahead is not None]

    def _compared(self, peer: Peer, now: float) -> list[Command]:
        ahead, was = self.ahead(peer), peer.tag in self._apart
        if ahead is None or (not was and abs(ahead) <= TUNING.clock_warning_above):
            return []
        uncertainty = peer.offset.uncertainty(now)
        if uncertainty > TUNING.clock_warning_ends_below:
            return []
        wrong = abs(ahead) - uncertainty > (TUNING.clock_warning_ends_below if was else TUNING.clock_warning_above)
        if wrong:
            self._apart[peer.tag] = ahead
        else:
            self.forget(peer.tag)
        if wrong == was:
            return []
        text = self._parted(peer, ahead) if wrong else f"the clocks of {peer.robot} and {self._robot} agree again"
        return [Notice("warning" if wrong else "info", text, {"reason": "clock"})]

    def _parted(self, peer: Peer, ahead: float) -> str:
        way = "ahead of" if ahead > 0.0 else "behind"
        differs = f"{abs(ahead):.3f} s {way} that of {self._robot}"
        return f"the clock of {peer.robot} is {differs}: timestamps cannot be compared"
