"""What may cross, by key and direction.

*Out* is what this robot offers: samples, deletes, the answers of its queryables, its liveliness tokens. *In* is what
others offer and this robot takes. A rule speaks of a key and of what accompanies it: the verbatim keys of advanced
pub/sub behind it (`<key>/@adv/…`) and the tokens of its ROS 2 publishers, subscribers, services and clients, be they of
`rmw_zenoh` or of Zenoh's bridge for DDS. `**` alone stands for every key, those with verbatim chunks too.
"""

import logging
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import Enum
from functools import lru_cache
from itertools import islice
from typing import NamedTuple

import zenoh

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.config import BridgeConfig
from proxy.profile import load_profile

log = logging.getLogger(__name__)


EVERYTHING = "**"
ADVANCED = "/@adv/"
ROS_TOKEN = "@ros2_lv"  # noqa: S105 - not a password
ROS_TOKEN_CHUNKS = 13
"""`@ros2_lv/domain/session/node id/id/kind/enclave/namespace/node/topic/type/hash/qos`, slashes in names as `%`."""
BRIDGED_TOKEN_CHUNKS = 5
"""`@/session/@ros2_lv/kind/key/type` of Zenoh's bridge for ROS 2 over DDS, and `qos` of topics, slashes as `§`."""
TAKERS = frozenset({"MS", "SC", "AC"})
"""The kinds of subscribers and clients."""


class Verdict(Enum):
    """What becomes of a sample."""

    DENIED = "denied"
    """It does not cross."""
    BYPASS = "bypass"
    """It crosses at once, whatever specs and planner say."""
    ORDINARY = "ordinary"
    """It crosses unless the planner says no."""
    COMPANION = "companion"
    """It is the heartbeat of an advanced publisher, and crosses where the numbers that it tells do."""


class Companion(NamedTuple):
    """The key that something accompanies. `takes`: it belongs to a subscriber or client, not to who offers the key."""

    key: str
    takes: bool


def companion(expression: str) -> Companion | None:
    """Return the key that a key or token of advanced pub/sub or ROS 2 accompanies; None: it stands for itself."""
    key, advanced, rest = expression.partition(ADVANCED)
    if advanced:
        return Companion(key, rest.startswith("sub/"))
    chunks = expression.split("/")
    if chunks[0] == "@" and chunks[2:3] == [ROS_TOKEN] and len(chunks) > BRIDGED_TOKEN_CHUNKS:
        return Companion(chunks[4].replace("§", "/"), chunks[3] in TAKERS)
    if chunks[0] != ROS_TOKEN or len(chunks) != ROS_TOKEN_CHUNKS:
        return None
    domain, kind, (topic, *type_and_hash) = chunks[1], chunks[5], chunks[9:12]
    name = topic.replace("%", "/").strip("/")
    return Companion("/".join((domain, name, *type_and_hash)), kind in TAKERS)


class Expressions:
    """A list of key expressions, as an operator writes it."""

    def __init__(self, texts: Iterable[str]) -> None:
        found = set(texts)
        self._everything = EVERYTHING in found
        self._keys = tuple(zenoh.KeyExpr(text) for text in sorted(found))

    def cover(self, expression: str) -> bool:
        """Whether `expression` lies wholly inside one of them."""
        return self._everything or self._any(zenoh.KeyExpr.includes, expression)

    def touch(self, expression: str) -> bool:
        """Whether `expression` has a key in common with one of them."""
        return self._everything or self._any(zenoh.KeyExpr.intersects, expression)

    def _any(self, relation: Callable[[zenoh.KeyExpr, zenoh.KeyExpr], bool], expression: str) -> bool:
        try:
            other = zenoh.KeyExpr(expression)
        except zenoh.ZError:  # a strange token of somebody's
            return False
        return any(relation(key, other) for key in self._keys)


class Direction:
    """One direction. `verdict` is asked for every sample: a cached look-up."""

    def __init__(self, allow: Iterable[str], deny: Iterable[str], bypass: Iterable[str] = ()) -> None:
        self.allow, self.deny, self._bypass = Expressions(allow), Expressions(deny), Expressions(bypass)
        self.verdict: Callable[[str], Verdict] = lru_cache(BOUNDS.keys)(self._verdict)
        self.lets: Callable[[str], bool] = lru_cache(BOUNDS.expressions)(self._lets)
        """Whether a declaration or query crosses: some of its keys are allowed, and it is not wholly denied."""
        self._lock = threading.Lock()
        self._denied: Counter[str] = Counter()
        self._withheld = dict.fromkeys(BOUNDS.crossing, 0)
        self._crossing: dict[str, dict[str, bool]] = {what: {} for what in BOUNDS.crossing}
        self.surplus = dict.fromkeys(BOUNDS.crossing, 0)
        """How many declarations are not mirrored until others of their kind are gone."""
        self._said: dict[str, float] = {}

    def count(self, what: str) -> None:
        """Count one of `what` ("samples", "queries", "replies") as denied."""
        with self._lock:
            self._denied[what] += 1

    def admits(self, what: str, key: str) -> bool:
        """Whether one of `what` crosses; it is counted when not."""
        if self.lets(key):
            return True
        self.count(what)
        return False

    def crossing(
        self, what: str, declared: Mapping[str, bool], lets: Callable[[str], bool] | None = None
    ) -> dict[str, bool]:
        """Leave out the declarations that do not cross, and remember how many of `what` those are.

        When there are too many those that have crossed stay, and of the others as many as there is room for.
        """
        lets, most = lets or self.lets, BOUNDS.crossing[what]
        if len(declared) <= most:
            found = {expression: complete for expression, complete in declared.items() if lets(expression)}
            self.surplus[what], self._withheld[what] = 0, len(declared) - len(found)
        else:
            before = self._crossing[what]
            found = {expression: declared[expression] for expression in before if expression in declared}
            others = (expression for expression in declared if expression not in before and lets(expression))
            found |= {expression: declared[expression] for expression in islice(others, most - len(found))}
            self.surplus[what] = len(declared) - len(found)
            self._say(what)
        self._crossing[what] = found
        return found

    def _say(self, what: str) -> None:
        now = clock.monotonic()
        if self.surplus[what] and now - self._said.get(what, -BOUNDS.warnings_apart) >= BOUNDS.warnings_apart:
            self._said[what] = now
            log.warning("%d %s too many are declared: `sendworthy status` says of whom", self.surplus[what], what)

    def describe(self) -> dict[str, int]:
        """How many samples, queries and replies were denied so far, and how many declarations are not shown now."""
        with self._lock:
            return {what: self._denied[what] for what in ("samples", "queries", "replies")} | self._withheld

    def _verdict(self, key: str) -> Verdict:
        # Who publishes on `**` publishes on every key, those that are denied too.
        names = _names(key)
        if not any(map(self.allow.cover, names)) or any(map(self.deny.touch, names)):
            return Verdict.DENIED
        if ADVANCED in key:
            return Verdict.COMPANION
        return Verdict.BYPASS if any(map(self._bypass.cover, names)) else Verdict.ORDINARY

    def _lets(self, expression: str) -> bool:
        names = _names(expression)
        return any(map(self.allow.touch, names)) and not any(map(self.deny.cover, names))


class Rules:
    """Both directions, from `[bridge]` and its profile."""

    def __init__(self, config: BridgeConfig) -> None:
        profile = load_profile(config.profile)
        out, into = config.out, config.into
        self.out = Direction(out.allow, (*out.deny, *profile.out.deny), (*out.bypass, *profile.out.bypass))
        self.into = Direction(into.allow, (*into.deny, *profile.into.deny))
        self.outward = self.out.verdict
        """What becomes of a sample of the robot's applications, by its key."""
        self._lets_token = {
            direction: lru_cache(BOUNDS.expressions)(_token_rule(direction, other))
            for direction, other in ((self.out, self.into), (self.into, self.out))
        }

    def tokens(self, direction: Direction, declared: Mapping[str, bool]) -> dict[str, bool]:
        """Leave out the tokens that do not cross in `direction`."""
        return direction.crossing("tokens", declared, self._lets_token[direction])

    def passing(self, direction: Direction, tokens: Iterable[str]) -> Iterator[str]:
        """Yield those `tokens` that cross in `direction`, all gone by now: no more than may be there at a time."""
        return islice(filter(self._lets_token[direction], tokens), BOUNDS.crossing["tokens"])

    def describe(self) -> dict[str, dict[str, int]]:
        """What was denied, by direction."""
        return {"out": self.out.describe(), "in": self.into.describe()}

    def warnings(self) -> list[str]:
        """Name what is too much to be mirrored. Subscribers are declared where samples go, all else where it is."""
        return [
            f"{'other nodes' if others is (what == 'subscribers') else 'applications of this robot'} declared too many "
            f"{what}: {_effect(count, taken_in=others and what == 'subscribers')}"
            for others, direction in ((True, self.out), (False, self.into))
            for what, count in direction.surplus.items()
            if count
        ]


def _effect(count: int, *, taken_in: bool) -> str:
    """Say what comes of it that so many are too many."""
    if taken_in:
        return f"for {count} of them all that applications publish is taken in"
    return f"{count} have no effect until others are gone"


def _token_rule(direction: Direction, other: Direction) -> Callable[[str], bool]:
    """Say which tokens cross: those of who takes a key are for who offers it, and offers go the other way."""

    def lets(token: str) -> bool:
        subject = companion(token)
        if subject is None or not subject.takes:
            return direction.lets(token)
        allowed = direction.allow.touch(token) or other.allow.touch(subject.key)
        return allowed and not direction.deny.cover(token) and not other.deny.cover(subject.key)

    return lets


def _names(expression: str) -> tuple[str, ...]:
    """Return all that a rule may call it by."""
    subject = companion(expression)
    return (expression,) if subject is None else (expression, subject.key)
