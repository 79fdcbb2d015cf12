"""The last decisions on each of our streams, for `sendworthy why`: as what led to them, words come when somebody asks.

Where samples of a stream meet the same fate for the same reason one after the other they are one entry. Of a problem,
which takes some 50 kB, constraints are kept and those competitors that the plan sends or that are worth most.
"""

from collections import Counter, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import nlargest
from typing import NamedTuple, Self

from planner import Aggregation, Message, MessageUtility, Plan, Problem
from planner.utility import integral
from proxy.core.market.standing import Weighed
from proxy.core.model.waiting import Waiting
from proxy.core.samples.tuning import TUNING
from proxy.core.window.forecast import Candidate
from utility_specs.lifetimes import initial


class Rival(NamedTuple):
    """A stream that took part in a decision, with the `size` of samples to come [B] and the `scale` of one to all.

    Of its `messages` that were open so many are `sent` by the plan.
    """

    robot: str
    key: str
    size: int
    scale: float
    utility: MessageUtility
    messages: int
    sent: int

    @property
    def worth(self) -> float:
        """What one message is worth in its first second [utility·s]."""
        return self.scale * integral(self.utility, 1.0)


@dataclass(frozen=True, slots=True)
class Searched:
    """A decision by a search: its plan, the constraints, and who competed; `asked` iterations were allowed.

    `this` is the stream of the sample; of other streams these `rivals`, and `more`. The search was `cut` for want of
    time. Its window held `held` messages, `full` of itself. In `current` the sample `ends` a loss of so much a second.
    """

    plan: Plan
    constraints: tuple[str, ...]
    this: Rival
    rivals: tuple[Rival, ...]
    more: int
    asked: int
    cut: bool
    held: int
    full: int
    ends: float = 0.0

    @classmethod
    def of(
        cls, plan: Plan, problem: Problem, candidates: Sequence[Candidate], full: int, asked: int, *, cut: bool
    ) -> Self:
        """Take what is kept out of the problem of a decision and its plan."""
        messages, current = problem.messages, problem.messages[problem.current]
        opened = [message for message in messages if not message.sent and message is not current]
        counts = Counter([message.stream for message in opened])
        sent = Counter([messages[place].stream for place in plan.sends if place != problem.current])
        first = {message.stream: message for message in reversed(opened)}
        first[current.stream] = current

        def rival(of: int) -> Rival:
            stream, audience, message = candidates[of].stream, candidates[of].audience, first[of]
            scale = message.scale * audience.share
            return Rival(stream.robot, stream.key, candidates[of].size, scale, message.utility, counts[of], sent[of])

        others = [(of in sent, message.scale, of) for of, message in first.items() if message is not current]
        kept = tuple([rival(of) for _, _, of in nlargest(TUNING.rivals, others)])
        names, more = tuple([constraint.name for constraint in problem.constraints]), len(others) - len(kept)
        ends = _ended(problem, current) * candidates[current.stream].audience.share
        return cls(plan, names, rival(current.stream), kept, more, asked, cut, len(opened), full, ends)


def _ended(problem: Problem, current: Message) -> float:
    """Return what a receiver loses a second by what the last message sent shows in excess of the current one."""
    if problem.streams[current.stream].aggregation is not Aggregation.CURRENT:
        return 0.0
    last = [m for m in problem.messages if m.sent and m.stream == current.stream][-1:]
    return sum(initial(m.utility) * max(0.0, m.scale - current.scale) for m in last)


class Why(NamedTuple):
    """What becomes of a sample, its `reason`, and why: the limits `lacking` room, which what is `beside` takes."""

    reason: str
    cause: str = ""
    lacking: tuple[str, ...] = ()
    beside: str = ""
    weighed: Weighed | None = None
    searched: Searched | None = None


SEARCH, RULE = "search", "rule"
"""Causes besides `Shortcut`: a search decided, or the static rule as it failed."""
BOOKED, RIVALS = "booked", "rivals"
"""What takes room besides what was sent: streams that are sent by what room costs, and other robots at this moment."""
WAITS = "waits"
"""The reason while a sample or a copy is not sent yet."""


class Entry:
    """What became of `count` samples of a stream, from `since` until `until` [s]; `sample` is the last one.

    It was the `number`-th of all, the `nth` of its stream. `shadowed`: sent all the same. `to`: a copy for that tag.
    """

    __slots__ = ("count", "nth", "number", "sample", "shadowed", "since", "to", "until", "why")

    def __init__(self, now: float, sample: Waiting | None, why: Why, to: str, *, shadowed: bool) -> None:
        self.since = self.until = now
        self.count = self.nth = self.number = 0
        self.sample = sample
        self.why = why
        self.to = to
        self.shadowed = shadowed

    def takes(self, why: Why, to: str, *, shadowed: bool) -> bool:
        """Whether the same happens again."""
        ours = self.why
        alike = ours is why or (ours.searched is None and why.searched is None and ours[:4] == why[:4])
        return alike and to == self.to and shadowed is self.shadowed

    def again(self, now: float, sample: Waiting | None, why: Why, *, count: int, number: int, nth: int) -> None:
        """It happened to so many more samples."""
        self.until = now
        self.sample = sample
        self.why = why
        self.count += count
        self.number = number
        self.nth = nth


class _Stream:
    """The entries of one stream, the oldest first, and how many samples they and those before them were."""

    __slots__ = ("decided", "entries")

    def __init__(self) -> None:
        self.decided = 0
        self.entries: deque[Entry] = deque(maxlen=TUNING.entries)

    def last(self, why: Why, to: str, *, shadowed: bool) -> Entry | None:
        """Return the last entry if the same happens again."""
        entries = self.entries
        return entries[-1] if entries and entries[-1].takes(why, to, shadowed=shadowed) else None

    def count(self, more: int) -> int:
        """So many more samples were decided; return how many they are."""
        self.decided += more
        return self.decided


class DecisionLog:
    """Keeps the last decisions, bounded: so many of each stream, so many streams, and so many searches in all."""

    def __init__(self) -> None:
        self.noted = 0
        """Decisions so far."""
        self._streams: dict[str, _Stream] = {}
        """By key, the one longest without a new entry first."""
        self._searched: deque[tuple[str, Entry]] = deque()

    def __iter__(self) -> Iterator[str]:
        return iter(self._streams)

    def of(self, key: str) -> list[Entry]:
        """Return what is known of a stream, the oldest first."""
        stream = self._streams.get(key)
        return [] if stream is None else list(stream.entries)

    def note(
        self,
        now: float,
        key: str,
        sample: Waiting | None,
        why: Why,
        *,
        count: int = 1,
        to: str = "",
        shadowed: bool = False,
        since: float | None = None,
        number: int | None = None,
    ) -> None:
        """This became of `count` samples of ours, from `since` on; the last is decision `number`, or the next."""
        number = self.noted + 1 if number is None else number
        self.noted = max(self.noted, number)
        stream = self._streams.get(key) or self._admit(key)
        entry = stream.last(why, to, shadowed=shadowed)
        if entry is None:
            entry = Entry(now if since is None else since, sample, why, to, shadowed=shadowed)
            self._add(key, stream, entry)
        entry.again(now, sample, why, count=count, number=number, nth=stream.count(count))

    def _admit(self, key: str) -> _Stream:
        """A stream is new; of too many the one longest without a new entry is forgotten."""
        if len(self._streams) >= TUNING.logged_streams:
            del self._streams[next(iter(self._streams))]
        self._streams[key] = stream = _Stream()
        return stream

    def _add(self, key: str, stream: _Stream, entry: Entry) -> None:
        """Take in an entry of a stream; of too many searches the oldest is forgotten."""
        stream.entries.append(entry)
        self._streams[key] = self._streams.pop(key)
        if entry.why.searched is not None:
            self._searched.append((key, entry))
            if len(self._searched) > TUNING.logged_searches:
                self._forget(*self._searched.popleft())

    def _forget(self, key: str, entry: Entry) -> None:
        stream = self._streams.get(key)
        if stream is not None and entry in stream.entries:
            stream.entries.remove(entry)
