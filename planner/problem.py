"""A planning problem: the messages of one window, what they are worth, and what the channel allows.

Everything here is frozen data, and what a decision has a hundred of are tuples, which are made in a third of the time.
Times are seconds on one monotonic clock of the caller's choice, sizes are bytes. The terms are those of the model: a
*stream* is one key of one robot, a *message* is a sample as the planner sees it, a *constraint* limits what the
messages sent within a sliding window may use together (Eq. 5 and 6).
"""

from collections.abc import Hashable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

from planner.utility import MessageUtility

if TYPE_CHECKING:
    from planner.columns import Columns


class Aggregation(StrEnum):
    """How the messages of one stream combine at a time t."""

    MOST_RECENT = "most_recent"
    """The utility is that of the message received last (Markovian, §3.2.2)."""
    BEST = "best"
    """The utility is the greatest of all that was received."""
    SUM = "sum"
    """The utilities of all that was received add up."""
    ONCE = "once"
    """The utility is that of the message received first; nothing after it is worth anything."""
    CURRENT = "current"
    """The utility is that of the message received last, less what is lost while its scale exceeds that of the newest
    message generated, sent or not (Markovian)."""


MARKOVIAN = frozenset({Aggregation.MOST_RECENT, Aggregation.CURRENT})
"""The aggregations of whose messages the one received last is all that counts."""


class Message(NamedTuple):
    """A sample as the planner sees it.

    `use[k]` is what sending it uses of constraint `k` (bytes for `throughput`; 0 where the constraint does
    not concern it). `scale` multiplies the message utility: weight × scale expression. A message with `sent` is a
    fact: it is counted and never decided. All others are decisions of the tree.
    """

    stream: int
    t_gen: float
    t_sent: float
    t_rcv: float
    utility: MessageUtility
    scale: float
    use: tuple[float, ...]
    sent: bool = False


@runtime_checkable
class AggregationModel(Protocol):
    """An aggregation of the caller's own: what any set of received messages of a stream is worth ("any U", §2.2).

    Messages are added in the order of receipt. Of equal states the planner keeps one, so states are best small and
    hashable; they are never changed in place. A stream may hold the messages of several robots, where what one
    sends makes the other's superfluous.
    """

    def empty(self) -> Hashable:
        """Return the state in which nothing was received."""

    def add(self, state: Any, message: Message) -> Hashable:
        """Return the state once `message`, too, was received at its `t_rcv` [s]."""

    def value(self, state: Any, t_end: float) -> float:
        """Return what the messages of a state are worth until `t_end` [s], their scales included [utility·s]."""


class Receiver(NamedTuple):
    """Somebody who wants the messages of a stream, or several alike.

    Each message arrives `delay` [s] after its `t_rcv`, and counts `share` times: how many they are × their weight ×
    the part of messages that is expected to arrive.
    """

    delay: float = 0.0
    share: float = 1.0


class Latest(NamedTuple):
    """When the newest sample of a stream was generated that is known [s], and its scale."""

    t_gen: float
    scale: float


class Stream(NamedTuple):
    """The samples of one key from one robot. What nobody receives is worth nothing.

    With `current` every message of the problem counts as generated at its `t_gen`, sent or not. `newest` adds the
    newest sample so far where that is no message: it was dropped, say.
    """

    robot: int
    aggregation: Aggregation | AggregationModel = Aggregation.MOST_RECENT
    receivers: tuple[Receiver, ...] = (Receiver(),)
    newest: Latest | None = None


@dataclass(frozen=True, slots=True)
class Constraint:
    """What is sent within any closed window of `window` seconds may use at most `limit` (Eq. 5, 6).

    A message that alone uses more than `limit` is checked against the window stretched to `use / limit ×
    window`: it may be sent when nothing else was sent within that.
    """

    name: str
    window: float
    limit: float


class Traffic(NamedTuple):
    """Something that was sent and uses the constraints, but is not a message of any stream of the problem."""

    t_sent: float
    use: tuple[float, ...]


@dataclass(frozen=True)
class Problem:
    """One decision: whether to send message `current`.

    `messages` are ordered by `t_gen` (ties by robot, then stream). Messages of `sent` are facts; `current` is
    never one. `t_start` is t_0 of Eq. 2's progress ψ, `t_end` ends every integral of utility. `t_sent` of the
    open messages does not decrease. `goes_on` tells that streams and constraints are in use after the window, too;
    without it the channel is left over at its end (the last window of a mission).
    """

    streams: tuple[Stream, ...]
    messages: tuple[Message, ...]
    current: int
    constraints: tuple[Constraint, ...]
    traffic: tuple[Traffic, ...]
    t_start: float
    t_end: float
    goes_on: bool = True

    @cached_property
    def columns(self) -> "Columns":
        """All of it as arrays."""
        from planner.columns import columns_of

        return columns_of(self)
