"""What this robot tells the others, and when: states, questions for theirs, digests; all within the team's allowance.

What was sent is told at once where it takes much of a limit, and ahead of the allowance if need be: it leaves the
others less. All other news wait until the allowance has room for them beside that.
"""

import math
import zlib
from dataclasses import replace
from operator import attrgetter

from proxy.core.congestion.channel import Channel
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.digest_budget import ANNOUNCEMENT, ON_AIR, OVERHEAD, QUESTION, DigestPacer
from proxy.core.gossip.excess import Talk
from proxy.core.gossip.retransmissions import Repeats
from proxy.core.gossip.state_announcements import as_told, differs, shortened, state_of, update_of
from proxy.core.gossip.state_requests import PACE, Asking
from proxy.core.interface.commands import AskState, Command, Notice, SendDigest, SendState
from proxy.core.model.limits import allowance_of, changes_plans, shortest_window, use_of
from proxy.core.model.transport import is_broadcast
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.protocol.codec import pack_digest, pack_state
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, tag
from proxy.core.samples.gate import Gate
from proxy.core.view.paths import mean_loss
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView

DIGESTS = 0.95
"""This part of the allowance is for digests, the rest for states: with all of it for digests robots told 103 to 105 %
of what they may, and tell 97 to 99 % now (four with cameras, five with samples of random sizes). Where limits follow
the channel digests tell of it, and have all."""
DEBT = 5.0
"""So much of the team's allowance may be spent ahead of time on telling what was sent [s]..."""
REPEATS_DEBT = 1.0
"""... so much on telling it again..."""
CHANGING_DEBT = 10.0
"""... so much on the first agreement on parts..."""
PARTS_DEBT, PARTS_PACE = 0.5, 0.05
"""... and so much on news of parts, which are told this far apart at least [s]."""
FIRST = 15.0
"""The first agreement on parts may take the allowance of so long [s]: nobody sends meanwhile, but for the floor."""
IDLE = 1.0
"""Who is alone looks this often whether there is something to tell [s]."""
APART = 1e-3
"""Two digests are so far apart at least [s]: each is told from the others by its time."""
LEAST_SENDS = 2.0
"""A team is taken to send at least so many messages in a window that have to be announced."""
STATE_PACE = 0.2
"""States follow each other at least this far apart [s]."""
ON_ITS_WAY = 0.3
"""An update of a state may come so much later than a digest that speaks of it [s]."""
GATHER = 0.25
"""New streams that are not large are told of so late, together with others that begin with them [s]; large ones at
once, ahead of the allowance: where the next state waited for that, eight robots knew of each other's cameras after 2 to
5 s, and two to five sent at one moment."""
PUSHED_APART = 2.0
"""Who comes to a large team hears of subscriptions together with all who come within so long [s]."""
RESTATE = 1.0
"""While samples come, our state is looked at this often: whether the periods are still right [s]."""

_CHANGES = attrgetter("changes")


class Telling:
    """One robot's part of the conversation. `urgent`: something changed enough to alter others' plans."""

    def __init__(self, now: float, view: SharedView, coordination: Coordination, gate: Gate, channel: Channel) -> None:
        self._view = view
        self._coordination = coordination
        self._gate = gate
        self._channel = channel
        # Before parts are agreed on nobody sends: the first agreement may use what samples leave.
        saved = FIRST if view.settings.coordination == "split" else 0.0
        self.pacer = DigestPacer(now, zlib.crc32(view.settings.zid.encode()) / 2**32, saved)
        self.asking = Asking(now)
        self._talk = Talk()
        self._repeats = Repeats()
        self._allowance = MODEL.least_allowance
        """What all robots may tell each other [B/s]."""
        self._uncounted = 0.0
        """What was told beyond the allowance and does not count against the limits yet; less: ahead of time [B]."""
        self.urgent = False
        self.parts_changed, self._parts_since = False, math.inf
        """Whether what we tell of parts is news, and since when [s]."""
        self.untold = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self.state = State(view.settings.robot, view.settings.zid, "", "")
        """The one that was told last; number 0: none."""
        self._told_at = -math.inf
        self._told_messages = 0
        """Messages put on the air by us as we told last."""
        self._state_at = self._restated = now - STATE_PACE
        self._restate_at = now
        """When to look whether our state is news."""
        self._large_is_new = False
        """Whether that is of a stream that others plan with."""
        self._push_at, self._pushed = math.inf, -math.inf
        """When our state is told to all who have come, and when it is, or was, for the last time [s]."""
        self._next_digest = -math.inf
        """When the next digest is due, as things are since the last event [s]."""
        self._looked_at = (0, 0, -1)
        """Of which changes of our streams and of what was told of them it is known whether they are news."""
        self._unknown = self._news = False

    def next_at(self, now: float) -> float:
        """When something is due at the latest, as far as that is known."""
        due = min(self._next_digest, self.asking.next_at(), self._push_at)
        # Where the rest is due sooner it does not matter when the allowance has paid for a state.
        return due if due <= self._restate_at else min(due, max(self._restate_at, self._state_due(now)))

    def restate(self, at: float) -> None:
        """Our state may be news; look then [s]."""
        self._restate_at = min(self._restate_at, at)

    def restate_stream(self, now: float, size: int, *, new: bool) -> None:
        """A stream has a sample of so many bytes: its period may be another one, or it is `new`.

        Look at once where it is news that others plan with, else when it is time to.
        """
        large = new and self._changes_plans(size, 1)
        self._large_is_new |= large
        self.restate(now if large else max(now + GATHER, self._restated + (0.0 if new else RESTATE)))

    def met(self, now: float) -> None:
        """Somebody came: of a large team, where it may ask only a few, it hears from us what our apps subscribe to."""
        self.pacer.forget()
        if self._coordination.team.large and self.state.subscriptions and math.isinf(self._push_at):
            self._push_at = self._pushed = max(now + GATHER, self._pushed + PUSHED_APART)

    def answered(self, now: float) -> None:
        """Somebody asked for our state and got it: all the rest is told by the next digest."""
        self._owe(now, len(pack_state(self.state)), 1)
        self.pacer.forget()

    def due(self, now: float) -> list[Command]:
        """Tell what is due now."""
        commands: list[Command] = []
        if now >= self._restate_at and now >= self._state_due(now):
            commands += self._send_state(now)
        if now >= self._push_at:
            self._push_at = math.inf
            self._owe(now, len(pack_state(self.state)), self._copies())
            commands.append(SendState(self.state, None))
        pace = self.pacer.question_takes() if self._coordination.team.large else PACE
        if (name := self.asking.due(now, pace)) is not None:
            self._owe(now, QUESTION, 1)
            commands.append(AskState(self._view.peers[name].name, name))
        self._tell(now, commands)
        return commands

    def look_for_state(self, now: float, name: str) -> None:
        """Ask a robot for its state if its digests speak of another one than we have.

        Of an older one only a digest tells that has just come: others are older than a state that has.
        """
        peer = self._view.peers[name]
        if peer.state is None:
            self.asking.want(now, name)
        elif peer.digest is not None and (
            peer.digest.state > peer.number or (peer.digest_received == now and 0 < peer.digest.state < peer.number)
        ):
            self.asking.want(now + ON_ITS_WAY, name)
        else:
            self.asking.done(name)

    def set_rate(self) -> None:
        """Take note of what all robots may tell each other, and how many they are."""
        robots = len(self._view.peers) + 1
        allowance = self._view.settings.allowance * self._channel.allowance_factor
        follows = bool(self._channel.capacity.factors)
        self._allowance = allowance_of(self._view.specs, allowance, robots)
        copies = 1 if self._view.settings.digests_on_air else robots
        self.pacer.set_rate((1.0 if follows else DIGESTS) * self._allowance, robots, copies, follows=follows)

    def heard(self, now: float, size: int) -> None:
        """A digest of another robot, of so many bytes, came: it was paid for from the allowance of all."""
        # For each one that comes others are lost.
        told, copies = round(size / (1.0 - mean_loss(self._view))), self._digest_copies()
        self.pacer.spent(now, told, copies)
        self._count(now, told, copies)

    def heard_state(self, now: float, state: State, size: int) -> None:
        """A state of another robot, of so many bytes, came: an update is for all, a whole one mostly for us alone."""
        self._count(now, size, self._copies() if state.since else 1)

    def _owe(self, now: float, size: int, copies: int) -> None:
        """We tell something that is no digest, of so many bytes, in so many copies."""
        self.pacer.owe(now, size, copies)
        self._count(now, size, copies)

    def _count(self, now: float, size: int, copies: int) -> None:
        """Count what is told against the limits, as far as it is more than they leave to that."""
        if window := self._window:
            told = (size + OVERHEAD) * max(1, copies)
            self._uncounted += self._talk.note(now, told, window, self._allowance * window)
            if self._uncounted > 0.0:  # ahead of what follows: where limits are of messages, each note is one
                ahead = max(self._uncounted, MODEL.least_digest)
                self._view.note_talk(now, math.ceil(ahead))
                self._uncounted -= ahead

    def _send_state(self, now: float) -> list[Command]:
        """Publish what is new of our state, or all of it, or nothing."""
        self._restate_at, self._restated, self._large_is_new = math.inf, now, False
        state, left = shortened(state_of(self._view, self._gate.appraisal.mode))
        if self.state.number and not differs(self.state, state):
            return []
        state = replace(as_told(self.state, state), number=self.state.number + 1)
        update = update_of(self.state, state)
        if update is not None and (until := self._state_at + self._takes(update)) > now:
            self._restate_at = until
            return []
        told: list[Command] = []
        if left > self.untold:
            told.append(Notice("warning", f"{left} streams, subscriptions or origins are too many to tell the others"))
        self.untold = left
        self.state, self._state_at = state, now
        for each in state.streams:
            if (stream := self._view.known(state.robot, each.key)) is not None:
                stream.usual_size = each.size
        self._owe(now, len(pack_state(update or state)), self._copies())
        return [*told, SendState(state, update)]

    def _takes(self, update: State) -> float:
        """Return how long news of our streams wait: nobody plans with them where a large team has equal parts [s]."""
        if not self._coordination.team.quiet:
            return 0.0
        return self.pacer.state_takes(len(pack_state(update)), self._copies())

    def _state_due(self, now: float) -> float:
        ahead = self._large_is_new and not self._coordination.team.large
        return max(self._state_at + STATE_PACE, now if ahead else self.pacer.state_due(now))

    def _tell(self, now: float, commands: list[Command]) -> None:
        """Send a digest if one is due, and see when the next one is."""
        if self._digest_due(now) <= now:
            commands.append(self._send_digest(now))
        elif self._repeat_due(now) <= now and (again := self._repeats.again(now)) is not None:
            commands.append(self._repeat(now, again))
        self._next_digest = min(self._digest_due(now), self._repeat_due(now))

    def _digest_due(self, now: float) -> float:
        if not self._view.peers:
            return now + IDLE
        return max(self._told_at + APART, self._wanted(now))

    def _repeat_due(self, now: float) -> float:
        return max(self._told_at + APART, self._repeats.due_at, self.pacer.due_ahead(now, REPEATS_DEBT))

    def _wanted(self, now: float) -> float:
        """When the allowance and what there is to tell have us tell something [s]."""
        self._look_for_news()
        news = (
            self._news
            or not self._coordination.settled
            or self._view.messages != self._told_messages
            or self._channel.capacity.probe_due(now)
        )
        splits, begins = self._coordination.team.splits, self._coordination.begins(now)
        self.pacer.follow(now, splits=splits, quiet=self._coordination.team.quiet, begins=begins, window=self._window)
        due = self.pacer.due(now, news=news, copies=self._digest_copies())
        if self._coordination.forming(now) and not self.parts_changed:
            return max(due, now + IDLE)
        if self._sent_much():
            return min(due, self.pacer.due_ahead(now, DEBT))
        self._parts_since = min(self._parts_since, now) if self.parts_changed else math.inf
        if self.parts_changed:
            # Who changes over speaks among announcements, which are ahead of the allowance, and may be more so.
            if not self._coordination.formed:
                return min(due, max(self.pacer.due_ahead(now, CHANGING_DEBT), self._told_at + PARTS_PACE))
            since = -math.inf if self._coordination.passes_on else self._parts_since
            in_turn = self.pacer.due_in_turn(now, since, PARTS_DEBT, self._digest_copies())
            return min(due, max(in_turn, self._told_at + PARTS_PACE))
        return min(due, self.pacer.due_ahead(now, 0.0)) if self.urgent and not splits else due

    @property
    def _window(self) -> float:
        """The shortest window of what robots share [s]; none where they share nothing."""
        shortest = shortest_window(self._gate.limits)
        return 0.0 if math.isinf(shortest) else shortest

    def announcing(self, now: float) -> float:
        """Return what part of the allowance it takes to announce all that the limits let the team send."""
        if self._overheard:
            return 0.0
        limits, rate, load = self._gate.limits, 0.0, [0.0] * len(self._gate.limits)
        for stream in self._view.competition.all(now):
            use = use_of(round(stream.mean_size), self._view.copies(stream), limits)
            if changes_plans(use, limits):
                often = 1.0 / stream.period
                rate += often
                load = [before + often * each for before, each in zip(load, use, strict=True)]
        fits = [c.limit / c.window / each for c, each in zip(limits, load, strict=True) if c.shared and each > 0.0]
        # Of a large team little is known for long; but that it sends some messages in each window.
        most = max(min([1.0, *fits]) * rate, LEAST_SENDS / shortest_window(limits))
        return most * (ANNOUNCEMENT + OVERHEAD) * self._digest_copies() / self.pacer.rate

    def announces_at(self, now: float) -> float:
        """When what is sent now could be announced [s]."""
        waits = self._coordination.team.rivals and self._announces and not self._overheard
        return self.pacer.due_ahead(now, DEBT) if waits else now

    @property
    def _overheard(self) -> bool:
        """Whether others hear what we send, as samples are broadcast."""
        return is_broadcast(self._view.settings.transport)

    @property
    def _announces(self) -> bool:
        """Whether others plan with what we send."""
        return self._coordination.team.must_announce and not self._coordination.team.splits

    def _sent_much(self) -> bool:
        """Whether we sent something since the last digest that changes what others plan."""
        if not self._announces or self._view.messages == self._told_messages:
            return False
        return self._changes_plans(self._view.largest, 1)

    def _large(self, stream: Stream) -> bool:
        """Whether the samples of a stream change what others plan."""
        size = 0 if stream.sent is None else stream.sent.size
        return self._changes_plans(size, self._view.copies(stream))

    def _changes_plans(self, size: int, copies: int) -> bool:
        """Whether others plan with so many bytes in so many copies."""
        return changes_plans(use_of(size, copies, self._gate.limits), self._gate.limits)

    def _look_for_news(self) -> None:
        """See whether there is news of our streams, when something was noted of them or told."""
        changes = self._view.revision, sum(map(_CHANGES, self._view.own())), self.pacer.revision
        if changes != self._looked_at:
            own = list(self._view.own())
            self._looked_at = changes
            self._unknown, self._news = self.pacer.unknown(own), self.pacer.has_news(own)

    def _send_digest(self, now: float) -> Command:
        copies, lean, sent_much = self._digest_copies(), self._tells_parts(now), self._sent_much()
        self._told_at = now
        if sent_much and not (
            self.urgent
            or self.parts_changed
            or self._unknown
            or self._tells_all(now, copies)
            or (self._view.awaits_echo(now) and self.pacer.affordable_echoes(now, copies))
        ):
            return self._announce(now)
        digest = Digest(
            robot=self._view.settings.robot,
            tag=tag(self._view.settings.zid),
            sent=now,
            messages=self._view.messages,
            bytes=self._view.bytes,
            streams=() if lean else self.pacer.changed(now, list(self._view.own())),
            echoes=() if lean else self._echoes(now, copies),
            state=self.state.number,
            capacity=self._channel.capacity.report(now),
            splits=self._coordination.team.votes_to_split,
            split=self._coordination.announcement(now),
        )
        self._channel.capacity.reported(digest)
        self._coordination.announced(digest)
        self.urgent = self.parts_changed = False
        if sent_much and self._overheard:
            large = {stream.id for stream in self._view.own() if self._large(stream)}
            self._announced(self._brief(now, tuple(each for each in digest.streams if each.id in large)))
        return self._send(now, digest, aside=lean)

    def _echoes(self, now: float, copies: int) -> tuple[Echo, ...]:
        """Return some echoes. Where limits follow the channel they tell how long digests wait now."""
        quickest = not self._channel.capacity.factors
        echoes = self.pacer.echoes(now, self._view.echoes(now, quickest=quickest), copies)
        self._view.echoed(echo.peer for echo in echoes)
        return echoes

    def _tells_parts(self, now: float) -> bool:
        """Whether a digest tells of parts alone: nobody plans with others' streams where each has its own part."""
        coordination = self._coordination
        if not coordination.team.splits or not self.parts_changed:
            return False
        return coordination.forming(now) or not self._tells_all(now, self._digest_copies())

    def _tells_all(self, now: float, copies: int) -> bool:
        """Whether it is time to tell all that is new: announcements never take the place of that."""
        return self.pacer.due(now, news=self._channel.capacity.probe_due(now), copies=copies) <= now

    def _announce(self, now: float) -> Command:
        """Tell all at once what was sent, in as few bytes as that takes; what is small only if there is room."""
        own = list(self._view.own())
        told = {s.key for s in own if self._large(s)} if self.pacer.in_debt(now) else {s.key for s in own}
        digest = self._brief(now, self.pacer.changed(now, own, told))
        self._channel.capacity.evidence.digest_sent(now, self._view.messages)
        if self._overheard:
            self._announced(digest)
        return self._send(now, digest)

    def _brief(self, now: float, streams: tuple[StreamDigest, ...]) -> Digest:
        """Return the announcement of what streams sent."""
        return Digest(
            robot=self._view.settings.robot,
            tag=tag(self._view.settings.zid),
            sent=now,
            streams=self.pacer.usual(streams, self.state),
            state=self.state.number,
            brief=True,
        )

    def _announced(self, digest: Digest) -> None:
        """This goes out on the air, or something that says as much: it may have to be told again."""
        if digest.streams:
            self._repeats.announced(digest, mean_loss(self._view))

    def _repeat(self, now: float, digest: Digest) -> Command:
        """Tell once more what was sent."""
        self._told_at = now
        return self._publish(now, digest, announces=True)

    def _send(self, now: float, digest: Digest, *, aside: bool = False) -> Command:
        """Send a digest; `aside`: ordinary news have their turn all the same."""
        self._told_messages, self._view.largest = self._view.messages, 0
        return self._publish(now, digest, announces=digest.brief or aside)

    def _publish(self, now: float, digest: Digest, *, announces: bool) -> Command:
        """Send a digest, and count what it takes."""
        self._view.sent_digest(now)
        size, copies = self._size_of(digest), self._digest_copies()
        self.pacer.sent(now, size, copies, announces=announces)
        self._count(now, size, copies)
        return SendDigest(digest)

    def _size_of(self, digest: Digest) -> int:
        """The size of a digest [B]; on the air, where one for all goes, its key has no number to stand for it."""
        on_air = self._view.settings.digests_on_air
        return len(pack_digest(digest)) + (ON_AIR + len(self._view.settings.robot) if on_air else 0)

    def _digest_copies(self) -> int:
        """How often a digest for all is transmitted."""
        return 1 if self._view.settings.digests_on_air and self._view.peers else self._copies()

    def _copies(self) -> int:
        """How often a state is transmitted."""
        return len(self._view.peers) + (self._view.settings.relayed and bool(self._view.peers))
