"""Which robots to ask for their states: those that are new, and those whose digests name a state that we lack."""

import math

from proxy.core.gossip.tuning import TUNING
from proxy.core.view.peer import Peer


class StateRequests:
    """The questions that are open, by tag; there is at most one for each robot."""

    def __init__(self, now: float) -> None:
        self.due_at = math.inf
        """When the next question is due [s]."""
        self.asked = 0
        """How often we asked."""
        self._open: dict[str, tuple[float, float]] = {}
        """When to ask next [s], and how long to wait for the answer then [s]."""
        self._next = self._asked_at = now
        self._left = float(TUNING.questions_at_once)

    def want(self, now: float, tag: str) -> None:
        """We lack the state of a robot."""
        self._open.setdefault(tag, (now, TUNING.first_answer))
        self._plan()

    def done(self, tag: str) -> None:
        """We have the state of a robot, or the robot is gone."""
        self._open.pop(tag, None)
        self._plan()

    def compare(self, now: float, tag: str, peer: Peer) -> None:
        """Ask a robot for its state if its last digest names another one; an older one only if it has just come."""
        if peer.state is None:
            self.want(now, tag)
        elif peer.digest is not None and (
            peer.digest.state > peer.number or (peer.digest_received == now and 0 < peer.digest.state < peer.number)
        ):
            self.want(now + TUNING.update_delay, tag)
        else:
            self.done(tag)

    def take(self, now: float, apart: float = TUNING.questions_apart) -> str | None:
        """Return whom to ask now, who waits longest; None: nobody. In the long run questions are so far `apart` [s]."""
        if now < self.due_at:
            return None
        tag = min(self._open, key=lambda t: (self._open[t], t))
        _, wait = self._open[tag]
        self._open[tag] = now + wait, min(2.0 * wait, TUNING.longest_wait)
        self._left = min(TUNING.questions_at_once, self._left + (now - self._asked_at) / apart) - 1.0
        self._asked_at = now
        self._next = now + max(TUNING.questions_apart, -self._left * apart)
        self.asked += 1
        self._plan()
        return tag

    def _plan(self) -> None:
        first = min((when for when, _ in self._open.values()), default=math.inf)
        self.due_at = max(self._next, first) if self._open else math.inf
