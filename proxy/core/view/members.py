"""The other robots that are here, each under a name that no other one has."""

from collections.abc import Mapping

from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, tag
from proxy.core.view.peer import Peer
from proxy.core.view.tuning import TUNING


class Members:
    """The robots whose presence is known, by tag; `evicted` counts those for which there was no room."""

    def __init__(self, settings: CoreSettings) -> None:
        self._own = settings.robot, tag(settings.zid)
        self._peers: dict[str, Peer] = {}
        self.peers: Mapping[str, Peer] = self._peers
        self.tags: dict[str, str] = {}
        """The tags of all robots by their names, our own included."""
        self.evicted = 0
        self._aside: frozenset[str] = frozenset()
        """Tags of the robots that take no part."""
        self._note_names()

    def knows(self, zid: str) -> bool:
        """Whether a robot of this id is here, or it is our own."""
        return tag(zid) in self._peers or tag(zid) == self._own[1]

    def evict(self) -> Peer | None:
        """There is no room for a new robot; return who has to leave as it said nothing yet, if anybody."""
        self.evicted += 1
        return next((p for p in self._peers.values() if not p.announced and p.digest is None), None)

    def add(self, now: float, robot: str, zid: str, *, plain: bool) -> None:
        """A robot came. Of robots of one name the later ones get another one here, with a part of their ids."""
        self._peers[tag(zid)] = Peer(self._free_name(robot, zid), zid, now, name=robot, plain=plain)
        self._note_names()

    def remove(self, zid: str) -> Peer | None:
        """A robot left; return what was known of it."""
        peer = self._peers.pop(tag(zid), None)
        self._note_names()
        return peer

    @property
    def speaking(self) -> int:
        """How many others there are, but for those that take no part as they say nothing."""
        return sum([not (peer.plain and peer.silent) for peer in self._peers.values()])

    @property
    def unannounced(self) -> int:
        """How many robots, of different names, may want what we send though they did not say so: Zenoh knows sooner."""
        return len({peer.name for peer in self._peers.values() if not (peer.announced or peer.plain)})

    def called(self, robot: str) -> Peer | None:
        """The peer of a name; of one that has restarted its new self, when the old one has not left yet."""
        return self._peers.get(self.tags.get(robot, ""))

    def set_aside(self, names: frozenset[str]) -> None:
        """The robots with these tags take no part."""
        self._aside = names

    def decides(self, robot: str, said: str | None) -> bool:
        """Whether a robot keeps limits with streams of a type of which specs say this mode, if they do."""
        peer = self.called(robot)
        if peer is None or peer.tag in self._aside:
            return False
        mode = peer.state.mode
        return (mode if said is None or mode == Mode.PASS else said) in ("", Mode.ENFORCE)  # it may not have said yet

    def heir_of(self, name: str) -> Peer | None:
        """Return the robot that has a name that is free now, but was given another one here."""
        return next((other for other in self._peers.values() if other.name == name), None)

    def restore_name(self, peer: Peer) -> None:
        """The one that had the name of this robot is gone."""
        peer.rename(peer.name)
        self._note_names()

    def _free_name(self, robot: str, zid: str) -> str:
        """The name of a robot, with as much of its id as nobody else's has."""
        taken = {peer.robot for peer in self._peers.values()} | {self._own[0]}
        names = (robot, *(f"{robot}-{zid[:length]}" for length in range(4, len(zid) + 1)))
        return next((name for name in names if name not in taken), f"{robot}-{zid}")

    def _note_names(self) -> None:
        self.tags = {peer.robot: name for name, peer in self._peers.items()} | dict((self._own,))


class UnknownSenders:
    """Keeps the last digests of each unknown sender until it appears; `forgotten` counts what had no room."""

    def __init__(self) -> None:
        self._heard: dict[str, list[tuple[float, Digest]]] = {}
        self.forgotten = 0

    def keep(self, now: float, digest: Digest) -> None:
        """Keep an unknown sender's digest; the sender heard of longest ago has to leave for a new one."""
        kept = self._heard.pop(digest.tag, [])
        self._heard[digest.tag] = kept
        kept.append((now, digest))
        if len(kept) > TUNING.unknown_digests:
            del kept[0]
            self.forgotten += 1
        if len(self._heard) > TUNING.unknown_senders:
            self.forgotten += len(self._heard.pop(next(iter(self._heard))))

    def introduce(self, tag: str) -> list[tuple[float, Digest]]:
        """Return what a robot said before we knew of it, oldest first, each with its receipt time."""
        return self._heard.pop(tag, [])
