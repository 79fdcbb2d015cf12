"""What goes on the air: how much this robot sent in all, and when other robots sent how much."""

from collections import Counter, deque
from collections.abc import Collection

from proxy.core.model.limits import Limit
from proxy.core.view.members import Members
from proxy.core.view.peer import Entry
from proxy.core.view.stream import Sent, Stream
from proxy.core.view.subscribers import Subscribers
from proxy.core.view.tuning import TUNING

WORDS = ""
"""Who sends what robots tell each other while that is more than their allowance: nobody's name."""


class TrafficLog:
    """Our own totals, copies counted, and the sends of others that limits still count."""

    def __init__(self, robot: str, members: Members, subscribers: Subscribers) -> None:
        self.robot = robot
        self._members = members
        self._subscribers = subscribers
        self.messages = 0
        self.bytes = 0
        self.largest = 0
        """The largest sample of a stream that we sent since the last digest, all copies of it [B]."""
        self.sends: deque[Entry] = deque(maxlen=TUNING.sends)
        self.revision = 0
        self._stretched = 0.0
        """For how long windows are stretched for messages larger than a limit [s]."""
        self.noted, self.retracted = 0, 0
        """How many sends of others were noted so far, and how many of them turned out to be none."""

    def count(self, messages: int, size: int, largest: int = 0) -> None:
        """So many messages of ours, of so many bytes in all, copies counted, go on the air, of at most `largest`."""
        self.messages += messages
        self.bytes += size
        self.largest = max(self.largest, largest)

    def note_sent(self, stream: Stream, count: int, sent: Sent) -> None:
        """The `count`-th sample sent of a stream was this one."""
        noted = stream.note_sent(count, sent)
        stream.reach(self._subscribers.of(stream))
        copies = self._subscribers.copies(stream)
        if stream.robot == self.robot:
            self.largest = max(self.largest, copies * sent.size)
        else:
            self.revision += 1
            self.noted += len(noted)
            decided = self._members.decides(stream.robot, stream.information_type.mode)
            self.sends.extend([(each.t_sent, (sent.size, copies), stream.robot, decided) for each in noted])

    def note_unknown(self, at: float, size: int, robot: str, copies: int = 1, *, planned: bool = True) -> Entry:
        """A robot sent something of a stream that we know nothing of, as a rule in one copy; return its entry."""
        entry = at, (size, copies), robot, planned and (robot == WORDS or self._members.decides(robot, None))
        self.revision += 1
        self.noted += 1
        self.sends.append(entry)
        return entry

    def note_words(self, at: float, size: int, copies: int) -> None:
        """Robots tell so much [B], in so many copies, while it is more than they may: limits leave no room for it."""
        self.note_unknown(at, size, WORDS, copies)

    def retract(self, entries: Collection[Entry]) -> None:
        """It is known now what streams these were: they count as samples of those."""
        leaving, before = Counter(entries), list(self.sends)
        if not leaving:
            return
        self.sends.clear()
        for each in before:
            if leaving.get(each, 0):
                leaving[each] -= 1
            else:
                self.sends.append(each)
        gone = len(before) - len(self.sends)
        self.revision += gone
        self.retracted += gone

    def sent_since(self, since: float) -> list[Entry]:
        """What other robots sent since then."""
        return [each for each in self.sends if each[0] >= since]

    def used(self, now: float, limit: Limit) -> float:
        """Return what other robots use of a limit in the window that ends now, as far as we know."""
        since, use = now - limit.window, limit.measure.use
        return sum(use(*amount, own=False) for at, amount, *_ in self.sends if at >= since)

    def stretch(self, longest: float) -> None:
        """Windows are stretched, the longest to so much [s]."""
        self._stretched = longest

    def remembered(self, longest: float) -> float:
        """Return for how long sends count, if the longest window is so long and not stretched [s]."""
        return max(longest, self._stretched)

    def announced(self) -> None:
        """A digest of ours tells what we sent so far."""
        self.largest = 0

    def sweep(self, now: float, longest: float) -> None:
        """Forget what no window counts, the longest of which is so long [s]; cheap to call at every event."""
        since = now - TUNING.windows_kept * self.remembered(longest)
        while self.sends and self.sends[0][0] < since:
            self.sends.popleft()
            self.revision += 1
