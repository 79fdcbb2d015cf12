"""When to tell the others what, within the allowance of the team.

The allowance is one bucket of bytes for all robots: each keeps its own picture of it, fills it at the whole rate, and
takes out what it tells and what it hears others tell. So those who have most to announce announce most, if need be
ahead of time. A part of it is for all else, and of that each robot has an equal part: ordinary news, and, paid for
later, states, questions and answers. What is told goes in turn: of echoes and of news that may have been lost, each
digest has a few.
"""

from collections import deque
from collections.abc import Container, Iterable
from dataclasses import replace

from proxy.core.forecast import rhythm_report
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.protocol.fixed import feature, rounded
from proxy.core.protocol.messages import Echo, State, StreamDigest
from proxy.core.view.stream import Stream, usual_scale

SLOW = 1.0
"""A digest goes out at least this often, and each peer is echoed at most so often [s]."""
OVERHEAD = 15
"""What Zenoh adds to a digest: the length of the batch, its frame, and the number for the key [B]."""
ANNOUNCEMENT = 16
"""An announcement is about so large [B]."""
ON_AIR = 60
"""What the key takes besides the robot's name where digests are broadcast [B]."""
QUESTION = 75
"""What asking for a state takes, the head of the answer included [B]."""
ANSWER = 75
"""A state without streams is about so large [B]."""
MOST_STREAMS = 32
"""News of at most this many streams in one digest."""
MOST_ECHOES = 8
"""Peers echoed in one digest."""
ORDINARY = 0.2
"""This part of the allowance is for all but announcements, and what they do not need."""
ON_CHANNEL = 0.7
"""... this part where limits follow the channel, as how long digests take tells of it..."""
STATES = 0.5
"""... and this part may go to states, questions and answers, while there are any."""
ANSWERS = 1.5
"""What all robots answer takes so many times what the allowance has room for meanwhile: other news go on beside it."""
GOLDEN = 0.618
"""Turns that move on by this part of a round fall evenly, and those of robots seldom together."""
FULL = 0.25
"""The allowance of so long may be left for later [s]."""
MOST_OWED = 10.0
"""The allowance of so long is owed at most [s]: who tells more than its part silences nobody for long."""
ECHO = 23
"""What an echo takes [B]..."""
ECHOING = 0.25
"""... and the part of the allowance that echoes may take in the long run."""
HEAD_START = 600.0
"""What echoes may take ahead of that [B]: without any nobody knows how long the way is."""
REFRESH = 10.0
"""What was told of a stream is told again after this time: it may have been lost [s]."""
MOST_REFRESHED = 2
"""Streams told again in one digest."""
UNHURRIED = 60.0
"""Where nobody plans with it ordinary news wait for the allowance of all for so long [s]; not where digests tell of the
channel: after agreeing on parts three robots told nothing for 3 to 5 s then, which was taken for a queue, and sent 10
to 40 % less."""
SAVED = 10.0
"""So much of the allowance may be saved for states [s]."""


class DigestPacer:
    """Spends the allowance of this robot."""

    def __init__(self, now: float, turn: float = 0.0, saved: float = 0.0) -> None:
        """Each robot begins with another `turn`, between 0 and 1; the allowance of so long was `saved` [s]."""
        self.revision = 0
        """How often what was told of streams changed."""
        self._rate, self._robots, self._copies, self._follows = MODEL.least_allowance, 1, 1, False
        self._saved, self._splits, self._quiet, self._window = saved, False, False, 0.0
        self._recent: deque[tuple[float, float]] = deque()
        """What all told in the last window, and when."""
        self._common = 0.0
        """What is left of the allowance of all."""
        self._tokens = MODEL.least_allowance
        """What is left of our part of what is for ordinary news."""
        self._debt = -SAVED * MODEL.least_allowance
        self._updated = now
        self._size, self._brief = 64.0, 48.0
        """What the last ordinary digest took, and the last other one [B]."""
        self._last = now - SLOW
        self._echoing = HEAD_START
        self._turn = turn
        """Of a digest so much more has to be left of the allowance for an ordinary one: it moves on with each."""
        self._echoed: dict[str, float] = {}
        self._ever: set[str] = set()
        """Own keys that were told of at all."""
        self._told: dict[str, tuple[float, StreamDigest]] = {}
        """What was last told of each own stream, by its key, and when."""
        self._digests: dict[str, tuple[Stream, int, StreamDigest]] = {}
        """What there is to tell of each stream, by its key, since so many changes of it."""

    def set_rate(self, rate: float, robots: int, copies: int, *, follows: bool = False) -> None:
        """The allowance of so many robots is now `rate` [B/s], all copies together; digests go in so many `copies`.

        `follows`: digests tell of a channel that limits follow, and have more of it beside announcements.
        """
        self._tokens += max(0, copies - self._copies) * self._size
        if self._saved:
            self._common += max(0.0, rate - self._rate) * self._saved
        self._rate, self._robots, self._copies, self._follows = rate, robots, copies, follows

    def follow(self, now: float, *, splits: bool, quiet: bool, begins: bool, window: float) -> None:
        """Each robot has its part or not, and the team `begins` or has done so; `window` is the shortest one [s].

        Where each has its part nobody plans with ordinary news; a large, `quiet` team tells them in turn from then on:
        of fifty robots five did within 15 ms, and some windows held 1.16 limits. Once a team has begun, what was saved
        for the first agreement is not needed any more, and ordinary news go on, each robot in its turn.
        """
        if quiet and not self._quiet:
            self._tokens = min(self._tokens, -self._turn * self._size * self._copies)
        self._splits, self._quiet, self._window = splits, quiet, window
        if self._saved and not begins:
            self._fill(now)
            self._saved, self._common = 0.0, min(self._common, 0.0)
            self._tokens = -self._turn * self._size * self._copies

    def unknown(self, streams: list[Stream]) -> bool:
        """Whether there is a stream that was never told of."""
        return any(s.key not in self._ever and s.last is not None for s in streams)

    @property
    def rate(self) -> float:
        """The allowance of all robots together [B/s]."""
        return self._rate

    def in_debt(self, now: float) -> bool:
        """Whether more was told than the allowance of all has room for."""
        self._fill(now)
        return self._common < 0.0

    def due(self, now: float, *, news: bool, copies: int) -> float:
        """When the next digest may go out in so many copies, in our clock [s]; now or earlier means at once.

        It is as large as the last one, and we tell no more than an equal part. For what the others tell we wait a
        second or two at most, and where windows are shorter than that for one window at least: of eight robots with
        cameras each tells something every ten seconds, and where two did at one moment 1.1 % of the windows were over
        the limit.
        """
        cost = self._size * copies
        self._fill(now)
        # Where all have waited for the allowance, they do not go on at the same moment.
        apart = 1.0 + self._turn
        affordable = now + (cost - self._tokens) / self._rate_of_own
        room = now + max(0.0, cost * apart - self._common) / self._rate
        fits, patience = self._fits_at(now, cost), UNHURRIED if self._splits and not self._follows else SLOW
        window = self._window if self._window < SLOW else 0.0
        until = max(affordable + window * apart, self._last + patience * apart)
        due = max(now, affordable, min(max(room, fits), until))
        if self._splits:
            due = max(due, fits)
        return due if news else max(due, self._last + SLOW)

    def due_ahead(self, now: float, seconds: float) -> float:
        """When a digest may go out that spends the allowance of so many seconds ahead of time, in our clock [s]."""
        self._fill(now)
        return now + max(0.0, -seconds * self._rate - self._common) / self._rate

    def due_in_turn(self, now: float, since: float, seconds: float, copies: int) -> float:
        """When a digest may go out that spends so much ahead of time, if all robots have one since then [s].

        Not at one moment, and where all take more than the allowance of a window in the time in which it has room for
        them: where ten robots answered a new bid at once up to 9 % of the windows were over the limit though each kept
        its part, by up to 0.23; none is now.
        """
        cost = self._size * copies
        takes = self._robots * self._brief * copies / self._rate
        turn = since + self._turn * ANSWERS * takes if takes > self._window else now
        return max(self.due_ahead(now, seconds * (1.0 - self._turn)), self._fits_at(now, cost), turn)

    def spent(self, now: float, size: int, copies: int) -> None:
        """Another robot told something of so many bytes, in so many copies."""
        self._fill(now)
        cost = (size + OVERHEAD) * max(1, copies)
        self._common = max(self._common - cost, -MOST_OWED * self._rate)
        self._recent.append((now, cost))

    def state_due(self, now: float) -> float:
        """When the next state may be published, in our clock [s]."""
        self._fill(now)
        return now + max(0.0, self._debt) / self._rate_of_states

    def state_takes(self, size: int, copies: int) -> float:
        """Return for how long a state of so many bytes, in so many copies, takes what we may spend on states [s]."""
        return (size + OVERHEAD) * copies / self._rate_of_states

    def question_takes(self) -> float:
        """Return for how long a question and its answer take the allowance, where all robots ask in turn [s]."""
        return (QUESTION + ANSWER) * self._robots / self._rate

    def sent(self, now: float, size: int, copies: int, *, announces: bool = False) -> None:
        """A digest of so many bytes went out in so many copies; `announces`: only what was sent."""
        self._fill(now)
        cost = (size + OVERHEAD) * max(1, copies)
        self._common -= cost
        self._recent.append((now, cost))
        if announces:
            self._brief = float(size + OVERHEAD)
            return
        self._size, self._last = float(size + OVERHEAD), now
        self._tokens -= cost
        self._turn = (self._turn + GOLDEN) % 1.0

    def owe(self, now: float, size: int, copies: int) -> None:
        """Something else of so many bytes went out in so many copies: it is paid for in time."""
        self._fill(now)
        self._debt += (size + OVERHEAD) * copies

    def changed(
        self, now: float, streams: list[Stream], announced: Container[str] | None = None
    ) -> tuple[StreamDigest, ...]:
        """News of own streams since they were last told of, the most changed first, and some that may be lost.

        Where anything is `announced` news of these keys that sent something since.
        """
        self.revision += 1
        known = {s.key for s in streams}
        self._told = {key: told for key, told in self._told.items() if key in known}
        self._digests = {key: digest for key, digest in self._digests.items() if key in known}
        current = [(s, d) for s in streams if (d := self._digest(s)) is not None]
        news = [(s, d) for s, d in current if s.key not in self._told or self._told[s.key][1] != d]
        if announced is not None:
            news = [(s, d) for s, d in news if s.key in announced and self._sent_of(s.key) != d.forwarded]
        news.sort(key=lambda entry: -self._weight(*entry))
        old = [(s, d) for s, d in current if s.key in self._told and now >= self._told[s.key][0] + REFRESH]
        old.sort(key=lambda entry: self._told[entry[0].key][0])
        refreshed = [entry for entry in old if entry not in news][:MOST_REFRESHED] if announced is None else []
        chosen = (news + refreshed)[:MOST_STREAMS]
        self._told.update({s.key: (now, d) for s, d in chosen})
        self._ever = (self._ever & known) | {s.key for s, _ in chosen}
        return tuple(digest for _, digest in chosen)

    def usual(self, streams: tuple[StreamDigest, ...], state: State) -> tuple[StreamDigest, ...]:
        """Return announcements without what is as usual, and without features."""
        sizes, own = {each.id: each.size for each in state.streams}, {s.id: s for s, _, _ in self._digests.values()}
        return tuple(_briefly(each, sizes.get(each.id, 0), usual_scale(own[each.id])) for each in streams)

    def echoes(self, now: float, echoes: Iterable[Echo], copies: int) -> tuple[Echo, ...]:
        """Some of the echoes, in a digest of so many copies: of those peers that were not echoed for longest."""
        known = {echo.peer: echo for echo in echoes}
        self._echoed = {peer: at for peer, at in self._echoed.items() if peer in known}
        due = [peer for peer in known if now >= self._echoed.get(peer, now - SLOW) + SLOW]
        most = self.affordable_echoes(now, copies)
        chosen = sorted(due, key=lambda peer: self._echoed.get(peer, -1e18))[:most]
        self._echoing -= ECHO * copies * len(chosen)
        self._echoed.update(dict.fromkeys(chosen, now))
        return tuple(known[peer] for peer in chosen)

    def affordable_echoes(self, now: float, copies: int) -> int:
        """Return how many echoes a digest of so many copies has room for."""
        self._fill(now)
        return min(MOST_ECHOES, int(self._echoing / (ECHO * max(1, copies))))

    def has_news(self, streams: list[Stream]) -> bool:
        """Whether any stream changed since it was last told of."""
        for stream in streams:
            if stream.last is None:
                continue
            _, told = self._told.get(stream.key, (0.0, None))
            # Counts are compared first: most news is seen by them, without making a digest of it.
            if told is None or (told.generated, told.forwarded) != (stream.generated, stream.forwarded):
                return True
            digest = self._digest(stream)
            if told is not digest and told != digest:
                return True
        return False

    def value_changed(self, stream: Stream) -> bool:
        """Whether the stream's value changed enough since it was last told of to alter others' plans."""
        told = self._told.get(stream.key)
        if told is None or stream.last is None:
            return stream.last is not None
        low, high = sorted((told[1].scale, stream.last.scale))
        return high - low > 0.25 * max(low, 1e-9)

    def forget(self) -> None:
        """Somebody new is there: everything is news again."""
        self.revision += 1
        self._told.clear()

    def _digest(self, stream: Stream) -> StreamDigest | None:
        """Return what there is to tell of a stream; it is made when the stream has changed."""
        known = self._digests.get(stream.key)
        if known is not None and known[0] is stream and known[1] == stream.changes:
            return known[2]
        digest = _of(stream)
        if digest is not None:
            self._digests[stream.key] = stream, stream.changes, digest
        return digest

    def _sent_of(self, key: str) -> int | None:
        """How many samples of a stream were sent as was last told; None: nothing was told of it."""
        return self._told[key][1].forwarded if key in self._told else None

    def _weight(self, stream: Stream, digest: StreamDigest) -> float:
        told = self._told.get(stream.key)
        return float("inf") if told is None else abs(digest.scale - told[1].scale) + digest.scale

    def _fits_at(self, now: float, cost: float) -> float:
        """When so much can be told that no window holds more than its allowance [s].

        The limits leave no more than that to digests. Who waits for the same moment goes on a little apart.
        """
        while self._recent and self._recent[0][0] <= now - self._window:
            self._recent.popleft()
        if self._saved:
            return now
        told, at = sum(each for _, each in self._recent), now
        for t, each in self._recent:
            if told + cost <= self._rate * self._window:
                break
            told, at = told - each, t + self._window + self._turn * cost / self._rate
        return at

    def _fill(self, now: float) -> None:
        """What came in since then."""
        if now <= self._updated:
            return
        elapsed, self._updated = now - self._updated, now
        full = max(FULL * self._rate, 2.0 * self._size * self._copies)
        self._common = max(self._common, min(self._common + elapsed * self._rate, full))
        came = elapsed * self._rate_of_own
        most = max(3.0 * self._size * self._copies, self._rate_of_own)
        self._echoing = min(max(most, HEAD_START), self._echoing + ECHOING * came)
        self._tokens = min(most, self._tokens + came)
        self._debt = max(self._debt - elapsed * self._rate_of_states, -SAVED * self._rate_of_states)

    @property
    def _rate_of_states(self) -> float:
        """Our part of what is for states, questions and answers [B/s]."""
        return STATES * self._rate / self._robots

    @property
    def _rate_of_own(self) -> float:
        """Our part of what is for ordinary news [B/s]: of all, as long as announcements leave it."""
        least = ON_CHANNEL if self._follows else ORDINARY
        return (least if self._common < 0.0 or self._splits else 1.0) * self._rate / self._robots


def _of(stream: Stream) -> StreamDigest | None:
    if stream.last is None:
        return None
    return StreamDigest(
        stream.id,
        stream.generated,
        stream.forwarded,
        stream.last.t_gen,
        stream.sent.t_sent if stream.sent else 0.0,
        stream.last.size,
        rounded(stream.last.scale),
        tuple(map(feature, stream.information_type.told(stream.last.features))) if stream.last.features else (),
        *rhythm_report.encoded(stream.schedule.rhythm, stream.generated, stream.last.t_gen),
    )


def _briefly(news: StreamDigest, size: int, scale: float) -> StreamDigest:
    """Return an announcement of a stream that is so large and worth so much as a rule."""
    said = -1.0 if news.scale == scale else news.scale
    plain = replace(news, scale=said, features=())
    return replace(plain, size=0) if news.size == size and said < 0.0 else plain
