"""What a search found on a sample and what it competed with, small enough to be kept.

A problem takes some 50 kB. What is kept of it is its constraints, and of the streams that competed the few that matter
most: those that the plan sends, and then those whose samples are worth most.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import nlargest
from typing import NamedTuple, Self

from planner import Aggregation, Message, MessageUtility, Plan, Problem
from proxy.core.samples.tuning import TUNING
from proxy.core.window.candidates import Candidate
from utility_specs.lifetimes import initial, integral


class Rival(NamedTuple):
    """A stream that took part in a decision: so many of its `messages` were open, and the plan sends some.

    `scale` is that of one message, to all that want it. `size` is that of the samples to come [B].
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

    `this` is the stream of the sample with its other messages, `rivals` are other streams, and there are `more`. The
    search was `cut` when it ended for want of time. Its window held so many messages, `held`, and `full` of itself.
    With `current` the sample `ends` a loss of so much a second: what was sent last shows too much by now.
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
