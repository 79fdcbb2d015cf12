"""What this robot tells the others, and when: states, questions for theirs, digests; all within the allowance.

Digests concern all where all plan for all. Where one robot leads, news concern it alone, and a grant whom it is for.
"""

import math
from dataclasses import replace
from operator import attrgetter

from proxy.core.asking import Asking
from proxy.core.capacity import BEAT
from proxy.core.channel import Channel
from proxy.core.codec import pack_digest, pack_state
from proxy.core.commands import AskState, Command, Notice, SendDigest, SendState
from proxy.core.digests import ON_AIR, QUESTION, SLOW, DigestPacer
from proxy.core.gate import Gate
from proxy.core.limits import LEAST_DIGEST, allowance_of
from proxy.core.shares import Shares
from proxy.core.stating import differs, shortened, state_of, update_of
from proxy.core.view import SharedView
from proxy.core.wire import Digest, Echo, State

LEADERS_PART = 0.35
"""Of what all robots may tell each other, this part is for the one that leads."""
FAR_LEADERS_PART = 0.6
"""... and this where news take so long that what is lost comes too late when it is told once more."""
AHEAD = 0.15
"""Others are lent what they need so much before they need it [s]."""
ALL_PART = 0.3
"""Where one robot leads, this part of the allowance is for telling all what concerns only some..."""
ALL_PACE = 60.0
"""... and they are told at least this often, or while it is saved up for, half as often [s]."""
ALL_LEAST = 10.0
"""... but not more often than this [s]."""
SAVING_PACE = 0.5
"""... and while that is saved up for, who leads hears of an adaptive limit's channel this often [s]."""
NEWS_PACE = 1.0
"""Who leads hears news that are not urgent this often [s]."""
LOSSES = (0.04, 0.2)
"""Where more than this part is lost, what is lent is told once more, as far as the allowance goes."""
RETOLD = 0.02
"""That comes so much later: of two digests that were sent at once the second one is nothing new [s]."""
LOSSES_PACE = 0.5
"""How much gets lost is looked at this often [s]."""
STRAGGLER_PACE = 0.3
"""Those who do not say that they follow are told of who leads this often [s]."""
ECHO_PACE = 2.0
"""Digests that concern one robot echo its own this often [s]."""
VAGUE = 0.03
"""... and more often where clocks are not known to this [s]."""
MOST_AT_ONCE = 8
"""Digests that go out at the same time."""
HELLO = 0.5
"""So long after it settled a robot waits with its first digest for somebody to lead [s]."""
STATE_PACE = 0.2
"""States follow each other at least this far apart [s]."""
ON_ITS_WAY = 0.3
"""An update of a state may come so much later than a digest that speaks of it [s]."""
RESTATE = 1.0
"""While samples come, our state is looked at this often: whether the periods are still right [s]."""

_CHANGES = attrgetter("changes")


class Telling:
    """One robot's part of the conversation. `urgent`: something changed enough to alter others' plans."""

    def __init__(self, now: float, view: SharedView, shares: Shares, gate: Gate, channel: Channel) -> None:
        self._view = view
        self._shares = shares
        self._gate = gate
        self._channel = channel
        self.pacer = DigestPacer(now)
        self.asking = Asking(now)
        self.urgent = False
        self.untold = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self.state = State(view.settings.robot, view.settings.zid, "", "")
        """The one that was told last; number 0: none."""
        self._settled_at = now + view.settings.settle
        self._told_all_at = self._told_at = now
        self._echoed_at: dict[str, float] = {}
        self._told_to: dict[str, float] = {}
        """When each of those who do not say that they follow was told last who leads [s]."""
        self._told_epoch, self._told_late = 0, False
        """Epochs, and whether who leads lends, are told at once, and paid for later."""
        self._told_messages = 0
        """Messages put on the air that we told of."""
        self._state_at = self._restated = now - STATE_PACE
        self._restate_at = now
        """When to look whether our state is news."""
        self._next_digest = -math.inf
        """When the next digest is due, as things are since the last event [s]."""
        self._looked_at = (0, 0, -1)
        self._lost_at, self._times = -math.inf, 1
        """Of which changes of our streams and of what was told of them it is known whether they are news."""
        self._unknown = self._news = False

    def next_at(self, now: float, *, digests: bool) -> float:
        """When something is due at the latest, as far as that is known; digests wait for a plan that is being made."""
        due = min(self._next_digest if digests else now + 1.0, self.asking.next_at())
        # Where the rest is due sooner it does not matter when the allowance has paid for a state.
        return due if due <= self._restate_at else min(due, max(self._restate_at, self._state_due(now)))

    def restate(self, now: float, *, soon: bool = True) -> None:
        """Our state may be news; look at once, or when it is time to."""
        self._restate_at = min(self._restate_at, now if soon else self._restated + RESTATE)

    def answered(self, now: float) -> None:
        """Somebody asked for our state and got it: all the rest is told by the next digest."""
        self.pacer.owe(now, len(pack_state(self.state)), 1)
        self.pacer.forget()

    def due(self, now: float, *, digests: bool) -> list[Command]:
        """Tell what is due now."""
        commands: list[Command] = []
        if now >= self._restate_at and now >= self._state_due(now):
            commands += self._send_state(now)
        if (name := self.asking.due(now)) is not None:
            self.pacer.owe(now, QUESTION, 1)
            commands.append(AskState(self._view.peers[name].name, name))
        if digests:
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
        """A part of what all may tell each other is for who plans for all; the others have news."""
        robots, part = len(self._view.peers) + 1, 1.0
        if self._gate.sharing and self._shares.leader and robots > 1:
            leaders = FAR_LEADERS_PART if self._gate.late else LEADERS_PART
            part = leaders * robots if self._shares.leads else 1.0 - leaders
        allowance = self._view.settings.allowance * self._channel.part
        self.pacer.set_rate(part * allowance_of(self._view.specs, allowance, robots))

    def speaks_again(self) -> float:
        """How far ahead we have to plan: until what we say after the next digest is heard [s]."""
        return (1 + self._gate.late) * self.pacer.interval + self._view.longest_way + AHEAD

    def _send_state(self, now: float) -> list[Command]:
        """Publish what is new of our state, or all of it, or nothing."""
        self._restate_at, self._restated = math.inf, now
        state, left = shortened(state_of(self._view, self._gate.mode))
        if self.state.number and not differs(self.state, state, rhythms=self._view.settings.coordination != "shares"):
            return []
        state = replace(state, number=self.state.number + 1)
        update = update_of(self.state, state)
        told: list[Command] = []
        if left > self.untold:
            told.append(Notice("warning", f"{left} streams, subscriptions or origins are too many to tell the others"))
        self.untold = left
        self.state, self._state_at = state, now
        self.pacer.owe(now, len(pack_state(update or state)), self._copies())
        return [*told, SendState(state, update)]

    def _state_due(self, now: float) -> float:
        return max(self._state_at + STATE_PACE, self.pacer.state_due(now))

    def _tell(self, now: float, commands: list[Command]) -> None:
        """Send the digests that are due, and see when the next one is."""
        for _ in range(MOST_AT_ONCE):
            self._next_digest = self._digest_due(now)
            if now < self._next_digest:
                return
            commands.append(self._send_digest(now))
        self._next_digest = self._digest_due(now)

    def _digest_due(self, now: float) -> float:
        sharing = self._gate.sharing and bool(self._view.peers)
        if sharing:
            if not self._shares.epoch and now < self._settled_at + HELLO:
                return self._settled_at + HELLO
            if self._rules_changed:
                return now
        self._look_for_news()
        if self._unknown and self._view.peers and self.pacer.solvent:
            return max(now, self._told_at + STRAGGLER_PACE)
        to = self._addressee(now)
        if sharing and not to and self._shares.leads and now < (all_due := self._told_all_at + self._all_pace()):
            return max(now, min([all_due, *map(self._retell_at, self._shares.stragglers)]))
        speak = self._channel.capacity.speak(now)
        news = speak or self.pacer.again or self._news or bool(self._shares.returned(now))
        # Where all plan for all, every message leaves the others less; who should overhear it may have lost it.
        sent = not sharing and self._view.messages != self._told_messages
        urgent = self.urgent or sent or (self._shares.leads and to in self._shares.stragglers)
        copies, spare = 1 if to else max(1, self._digest_copies()), 1 if sharing else 2
        # For its way alone a digest to one robot is small, however large the last one to all was.
        size = float(LEAST_DIGEST) if speak and to else None
        due = self.pacer.due(now, urgent=urgent, news=news, copies=copies, spare=spare, size=size)
        if self.pacer.again:
            return max(due, self._told_at + RETOLD)
        # What could be urgent later is not spent on news that nobody waits for.
        return due if urgent or speak or not to else max(due, self._told_at + NEWS_PACE)

    @property
    def _rules_changed(self) -> bool:
        """Whether all have to be told at once who leads, or by us as who leads that we lend from now on."""
        shares = self._shares
        return self._told_epoch != shares.epoch or (shares.leads and self._gate.late and not self._told_late)

    def has_news(self) -> bool:
        """Whether there is news of our streams."""
        self._look_for_news()
        return self._unknown or self._news

    def _look_for_news(self) -> None:
        """See whether there is news of our streams, when something was noted of them or told."""
        changes = self._view.revision, sum(map(_CHANGES, self._view.own())), self.pacer.revision
        if changes != self._looked_at:
            own = list(self._view.own())
            self._looked_at = changes
            self._unknown, self._news = self.pacer.unknown(own), self.pacer.has_news(own)

    def _send_digest(self, now: float) -> Command:
        to = self._addressee(now)
        if self._told_epoch != self._shares.epoch:
            self.pacer.forget()  # who leads now has perhaps not heard what concerned who led before
        copies = 1 if to else self._digest_copies()
        self._told_at = now
        if not to:
            self._told_all_at = now
        self._told_to = {
            name: now if to in ("", name) else self._told_to.get(name, -math.inf) for name in self._shares.stragglers
        }
        digest = Digest(
            robot=self._view.settings.robot,
            tag=self._shares.own,
            sent=now,
            epoch=self._shares.epoch,
            messages=self._view.messages,
            bytes=self._view.bytes,
            streams=self.pacer.changed(now, list(self._view.own())),
            grants=self.pacer.grants(to, self._often(now)),
            echoes=self.pacer.echoes(now, self._echoes(to), copies),
            state=self.state.number,
            capacity=self._channel.capacity.telling(now),
            returned=self._shares.returned(now),
            lends=self._gate.late,
        )
        self._shares.told_returned()
        self._channel.capacity.told(digest)
        self._told_epoch, self._told_messages, self._told_late = self._shares.epoch, digest.messages, digest.lends
        self._view.sent_digest(now)
        self.pacer.sent(now, self._size_of(digest, to), copies)
        self.urgent = bool(self.pacer.addressee(self._shares.grants(now), self._often(now))) and not self.pacer.again
        return SendDigest(digest, to)

    def _addressee(self, now: float) -> str:
        """In `shares`, news concern who leads, and what is lent whom it is lent to; nobody: all are told.

        All are told of an epoch, and now and then of the rest.
        """
        shares, peers = self._shares, self._view.peers
        if not self._gate.sharing or not peers:
            return ""
        if shares.leads:
            if self._rules_changed:
                return ""
            granted = self.pacer.addressee(shares.grants(now), self._often(now))
            # Who does not follow yet sends nothing; what is lent to others must not keep it waiting.
            to = self._straggler(now) or granted or self._next_to_time(now)
            return to if to in peers else ""
        told = now < self._told_all_at + self._all_pace() or self._saves(now)
        return shares.leader if shares.leader in peers and told else ""

    def _saves(self, now: float) -> bool:
        """Whether a digest to all is still saved up for: meanwhile who leads goes on hearing of the channel."""
        if now >= self._told_all_at + 2.0 * self._all_pace() or now < self._told_at + SAVING_PACE:
            return False
        copies = self._digest_copies()
        return self._channel.capacity.speak(now) and self.pacer.due(now, urgent=False, news=True, copies=copies) > now

    def _often(self, now: float) -> int:
        """How often it is told what is lent: once, or more where much gets lost; that is looked at now and then."""
        if now >= self._lost_at + LOSSES_PACE:
            lost = [part for peer in self._view.peers.values() for part in (peer.loss_in, peer.loss_out) if part]
            self._lost_at, self._times = (
                now,
                1 + self._gate.late + sum(max(lost, default=0.0) > most for most in LOSSES),
            )
        return self._times

    def _straggler(self, now: float) -> str:
        """Who has to be told again who leads: of those whose turn it is, the one told longest ago."""
        due = [(self._retell_at(name), name) for name in self._shares.stragglers]
        return min([(at, name) for at, name in due if now >= at], default=(0.0, ""))[1]

    def _retell_at(self, straggler: str) -> float:
        return self._told_to.get(straggler, -math.inf) + STRAGGLER_PACE

    def _next_to_time(self, now: float) -> str:
        """While an adaptive limit is used, all are told something in turn: how long it takes tells of the channel."""
        names = sorted(self._view.peers) if self._channel.capacity.speak(now) else []
        return names[int(now / BEAT) % len(names)] if names else ""

    def _echoes(self, to: str) -> tuple[Echo, ...]:
        """What a digest echoes: of whom it is sent to alone, or of all."""
        if not to:
            return self._view.echoes()
        offset = self._view.peers[to].offset
        vague = offset.uncertainty(self._told_at) > VAGUE
        pace = SLOW if self._channel.capacity.factors or vague else ECHO_PACE
        if offset.known and self._told_at - self._echoed_at.get(to, -math.inf) < pace:
            return ()
        echoes = self._view.echoes(to)
        if echoes:  # of whom nothing was heard yet the next digest has to tell
            self._echoed_at[to] = self._told_at
        return echoes

    def _all_pace(self) -> float:
        """How often all are told what concerns only some [s]."""
        return min(ALL_PACE, max(ALL_LEAST, self._digest_copies() * self.pacer.interval / ALL_PART))

    def _size_of(self, digest: Digest, to: str) -> int:
        """The size of a digest [B]; on the air, where one for all goes, its key has no number to stand for it."""
        on_air = self._view.settings.digests_on_air and not to
        return len(pack_digest(digest)) + (ON_AIR + len(self._view.settings.robot) if on_air else 0)

    def _digest_copies(self) -> int:
        """How often a digest for all is transmitted."""
        return 1 if self._view.settings.digests_on_air and self._view.peers else self._copies()

    def _copies(self) -> int:
        """How often a state is transmitted."""
        return len(self._view.peers) + (self._view.settings.relayed and bool(self._view.peers))
