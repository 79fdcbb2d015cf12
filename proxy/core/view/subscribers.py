"""Who wants a stream, who still gains by more of it, and in how many copies a sample of it goes on the air."""

from collections.abc import Collection, Iterable
from functools import lru_cache
from itertools import chain

import zenoh

from planner import Aggregation
from proxy.core.model.settings import CoreSettings, is_broadcast
from proxy.core.protocol.messages import tag
from proxy.core.view.members import Members
from proxy.core.view.stream import Stream
from proxy.core.view.streams import Streams
from proxy.core.view.tuning import TUNING


@lru_cache(maxsize=65_536)
def intersects(expression: str, key: str) -> bool:
    """Whether a subscription's key expression matches the key; an invalid one matches nothing."""
    return _intersects(expression, key)


def _intersects(expression: str, key: str) -> bool:
    if _takes_long(expression, key):
        return True
    one, other = _parsed(expression), _parsed(key)
    return one is not None and other is not None and bool(one.intersects(other))


def common(subscriptions: Collection[str], keys: Collection[str]) -> set[str]:
    """Return key expressions that match what both some subscription and some of the keys do, and little more."""
    if len(subscriptions) > TUNING.subscriptions_narrowed:
        return set(keys)
    return {_narrower(each, key) for each in subscriptions for key in keys if intersects(each, key)}


def _narrower(expression: str, key: str) -> str:
    """Return the narrower of two expressions that have something in common; where neither is, the first."""
    if _takes_long(expression, key):
        return key
    one, other = _parsed(expression), _parsed(key)
    return key if one is None or other is None or one.includes(other) else expression


def _takes_long(expression: str, key: str) -> bool:
    """Whether Zenoh may take long to compare them: it tries each place of every wildcard but `*`, one in the other."""
    deep, parts = expression.count("**"), expression.count("$*")
    if not 1 < deep + parts <= TUNING.wildcards:
        return deep + parts > TUNING.wildcards
    chunks = key.split("/")
    steps: int = len(chunks) ** deep * max(map(len, chunks)) ** parts
    return steps > TUNING.compared_places


@lru_cache(maxsize=16_384)
def _parsed(text: str) -> zenoh.KeyExpr | None:
    try:
        return zenoh.KeyExpr(text)
    except zenoh.ZError:
        return None


_By = dict[str, set[str]]
"""Who subscribes to each key expression, by tag."""


class Interest:
    """The subscriptions of all robots, which are named by their tags."""

    def __init__(self) -> None:
        self._of: dict[str, frozenset[str]] = {}
        self._exact: _By = {}
        self._patterns: _By = {}
        """Those with wildcards; the others have none."""
        self._wanting: dict[tuple[str, str], tuple[str, ...]] = {}

    def set(self, tag: str, expressions: Iterable[str]) -> None:
        """The apps of a robot now subscribe to these key expressions, and no others."""
        before, after = self._of.pop(tag, frozenset()), _told(expressions)
        if after:
            self._of[tag] = after
        for expression in before - after:
            by = self._like(expression)
            by[expression].discard(tag)
            if not by[expression]:
                del by[expression]
        for expression in after - before:
            self._like(expression).setdefault(expression, set()).add(tag)
        if before != after:
            self._wanting.clear()

    def wanting(self, key: str, publisher: str = "") -> tuple[str, ...]:
        """Return the tags of the robots whose apps subscribe to the key, in order, without that of its publisher."""
        found = self._wanting.get((key, publisher))
        if found is None:
            if len(self._wanting) >= TUNING.keys_answered:
                self._wanting.clear()
            tags = set().union(*(by for each, by in self._among(key) if _intersects(each, key)))
            found = self._wanting[key, publisher] = tuple(sorted(tags - {publisher}))
        return found

    def any_wanted(self, keys: Iterable[str], publisher: str) -> bool:
        """Whether any robot but the publisher subscribes to something that one of these key expressions matches."""
        return any(
            intersects(expression, key) for key in keys for expression, by in self._among(key) if by != {publisher}
        )

    def _like(self, expression: str) -> _By:
        return self._patterns if "*" in expression else self._exact

    def _among(self, key: str) -> Iterable[tuple[str, Collection[str]]]:
        """Return the expressions that have to be compared with a key or key expression, each with who subscribes."""
        exact = self._exact if "*" in key else {key: self._exact[key]} if key in self._exact else {}
        return chain(self._patterns.items(), exact.items())


def _told(expressions: Iterable[str]) -> frozenset[str]:
    """Return what a robot subscribes to; of too many expressions with wildcards all is meant."""
    told = frozenset(expressions)
    exact = frozenset(each for each in told if "*" not in each)
    return told if len(told) - len(exact) <= TUNING.patterns else exact | {"**"}


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
        transports = {peer.robot: peer.state.transport for peer in self._members.peers.values()}
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
        """Transmissions of one sample: one in broadcast, else one per robot known to want it, and one when relayed."""
        return self.copies_of(stream.robot, stream.key)

    def copies_of(self, robot: str, key: str) -> int:
        """The same of a robot's stream of which only the key may be known."""
        if robot in self._broadcasting:
            return 1
        receivers = len(self._interest.wanting(key, self._members.tags.get(robot, "")))
        return 1 + receivers if self._settings.relayed else max(1, receivers)
