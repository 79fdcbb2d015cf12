"""Who wants a stream, who still gains by more of it, and in how many copies a sample of it goes on the air."""

from collections.abc import Iterable

from planner import Aggregation
from proxy.core.model.settings import CoreSettings, is_broadcast
from proxy.core.protocol.messages import tag
from proxy.core.view.interest import Interest
from proxy.core.view.members import Members
from proxy.core.view.stream import Stream
from proxy.core.view.streams import Streams

NAMELESS = ("",)
"""Somebody whom no state names."""


class Subscribers:
    """The robots that subscribe to each stream, by tag; who changes them changes all streams at once."""

    def __init__(self, settings: CoreSettings, streams: Streams, members: Members) -> None:
        self._settings = settings
        self._streams = streams
        self._members = members
        self._interest = Interest()
        self._broadcasting: set[str] = set()
        self.own: tuple[str, ...] = ()
        """The key expressions that the apps of this robot subscribe to."""
        self.note_transports()

    def set_own(self, keys: tuple[str, ...]) -> None:
        """The apps of this robot now subscribe to these key expressions."""
        self.own = keys
        self.set(tag(self._settings.zid), keys)

    def set(self, name: str, keys: Iterable[str]) -> None:
        """The apps of the robot with this tag now subscribe to these key expressions."""
        self._streams.revise()
        self._interest.set(name, keys)

    def note_transports(self) -> None:
        """Look who broadcasts: a robot told by what transport its samples travel, or left."""
        transports = {peer.robot: peer.transport for peer in self._members.peers.values()}
        transports[self._settings.robot] = self._settings.transport
        broadcasting = {robot for robot, transport in transports.items() if is_broadcast(transport)}
        if broadcasting != self._broadcasting:
            self._streams.revise()
            self._broadcasting = broadcasting

    def of(self, stream: Stream) -> tuple[str, ...]:
        """Tags of the robots that want the stream; a nameless one when Zenoh knows of somebody whom no state names."""
        wanting = self._interest.wanting(stream.key, self._members.tags.get(stream.robot, ""))
        return wanting or (NAMELESS if stream.matching else ())

    def want(self, keys: Iterable[str]) -> bool:
        """Whether another robot wants anything that one of these key expressions matches."""
        return self._interest.any_wanted(keys, tag(self._settings.zid))

    def count(self, stream: Stream) -> int:
        """How many robots want the stream."""
        return len(self.of(stream))

    def gaining(self, stream: Stream) -> tuple[str, ...]:
        """Tags of those to which more of the stream is worth anything: of `once`, who were not sent any of it yet."""
        wanting = self.of(stream)
        if stream.information_type.aggregation is not Aggregation.ONCE:
            return wanting
        return tuple(name for name in wanting if name not in stream.reached)

    def broadcasts(self, robot: str) -> bool:
        """Whether all robots hear what this one sends."""
        return robot in self._broadcasting

    def overhears(self, robot: str) -> bool:
        """Whether we hear what another robot sends, but for what is lost."""
        return robot in self._broadcasting and self._settings.robot in self._broadcasting

    def copies(self, stream: Stream) -> int:
        """Transmissions that one sample costs: one per robot that is known to want it, and when relayed one more.

        In broadcast it is one for all.
        """
        if stream.robot in self._broadcasting:
            return 1
        wanting = self.of(stream)
        receivers = 0 if wanting == NAMELESS else len(wanting)
        return 1 + receivers if self._settings.relayed else max(1, receivers)
