"""Samples that are not taken up yet, as room opens soon or news of what others sent comes soon."""

import math

from proxy.core.coordination.claims import claim, first_at, news_take, opening
from proxy.core.coordination.tuning import TUNING as COORDINATION
from proxy.core.market.room import carried, pace_part
from proxy.core.market.standing import Amounts, Standing
from proxy.core.model.lifetimes import half_life
from proxy.core.model.limits import Limit, changes_plans, longest_window, shortest_window
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.samples.appraisal import Appraisal
from proxy.core.samples.followers import Followers
from proxy.core.samples.inbox import Inbox, place
from proxy.core.samples.tuning import TUNING
from proxy.core.view.stream import Stream


class Waits:
    """When the samples that wait for room can be taken up."""

    def __init__(self, appraisal: Appraisal, inbox: Inbox) -> None:
        self.wakes_at = math.inf
        """When the first of the samples that were looked at since the last `restart` can be taken up [s]."""
        self._appraisal = appraisal
        self._inbox = inbox
        self._view, self._budget, self._disputes = appraisal.view, appraisal.budget, appraisal.disputes
        self._followers = Followers(inbox)
        self._limits: tuple[Limit, ...] = ()
        """For room under these samples rest in the inbox."""

    def restart(self, now: float) -> None:
        """What rested until now can be taken again; all can, where other limits are in force."""
        if self._limits != self._budget.limits:
            self._limits = self._budget.limits
            self._inbox.wake(math.inf)
            self._followers.clear()
        self._inbox.wake(now)
        self._followers.release()
        self.wakes_at = math.inf

    def left(self) -> None:
        """A sample was taken out: those that followed it may be taken, as far as they lead now."""
        self._followers.release()

    @property
    def for_room(self) -> bool:
        """Whether a sample waits for room, not for a turn."""
        return bool(self._followers)

    def postpone(self, now: float, sample: Waiting) -> bool:
        """Let a sample wait if there is a reason to, or if an older one of its key does; return whether it waits."""
        stream = self._appraisal.stream_of(now, sample) if self._budget.limits else None
        waits = (
            stream is not None
            and self._appraisal.mode_of(stream) is Mode.ENFORCE
            and (self._for_others(now, stream, sample) or self._for_what_opens(now, stream, sample))
        )
        return waits or self._overtakes(sample)

    def give_way(self, now: float, stream: Stream, sample: Waiting, until: float) -> bool:
        """Put a sample back until others' sends are known, or then [s]; whether it waits, not too old or outdated."""
        known_at = max(now + TUNING.shortest_wait, min(until, now + news_take(self._view)))
        return self._put_back(stream, sample, known_at)

    def for_channel(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Put a sample back until the channel has carried what was sent; whether it waits, not too old or outdated."""
        free = self._channel_free(now, stream)
        return free > now and self._put_back(stream, sample, free)

    def _overtakes(self, sample: Waiting) -> bool:
        """Whether one of its key that came before it, and is no less urgent, waits and would go after it."""
        same = self._inbox.of(sample.key)
        return any(each.sample < sample.sample and place(each) < place(sample) for each in same)

    def _put_back(self, stream: Stream, sample: Waiting, until: float) -> bool:
        """Put a sample back into the inbox until then [s], unless a newer one replaces it or it is too old by then."""
        outdated = sample.markovian and self._inbox.of(sample.key)
        if outdated or until > sample.t_gen + TUNING.patience * self._disputes.patience(stream):
            return False
        self._inbox.put_back([sample])
        self._inbox.rest(sample, until)
        return True

    def _for_others(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Whether a large sample waits for what who was just met sent lately, or begins as we do (else 1.4 limits)."""
        until, limits = self._view.newcomers.greeted_by(now), self._budget.limits
        if now >= max(until, stream.began + COORDINATION.first_time):
            return False
        if not changes_plans(self._appraisal.use(stream, sample), limits):
            return False  # of thousands of new keys that are small nobody looks through all streams
        if not self._budget.alone:
            until = max(until, first_at(now, self._view, stream, limits))
        if now >= until:
            return False
        self.wakes_at = min(self.wakes_at, until)
        return True

    def _for_what_opens(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Whether a sample waits for room or for our turn: none does that nobody wants, or that nothing is worth."""
        if not self._view.subscribers.gaining(stream):
            return False
        standing = self._appraisal.weigh(now, stream, sample)
        if standing is Standing.HOPELESS:
            return False
        use = self._appraisal.use(stream, sample)
        if self._budget.by_turn(now, use):
            return self._for_turn(now, stream, sample, use)
        return self._for_room(now, stream, sample, use, standing)

    def _for_room(self, now: float, stream: Stream, sample: Waiting, use: Amounts, standing: Standing) -> bool:
        """Whether a sample waits, as something we sent soon leaves the window, or behind others that do."""
        appraisal, contested = self._appraisal, standing is Standing.CONTESTED
        until = sample.t_gen + self._disputes.patience(stream, standing)
        if now >= until:
            return False
        weighed = self._disputes.weighed(stream)
        priced = not contested and weighed.standing is Standing.PRICED and weighed.cost > 0.0
        leads = (
            (contested or priced) and not self._budget.alone and appraisal.claims.lead(now, stream, self._budget.limits)
        )
        kind = contested, leads
        if (before := self._followers.follow(kind, sample, use)) is not None:
            if before > until:
                return False
            self._inbox.rest(sample, until)
            return True
        if contested:
            needed = self._disputes.besides(now, use)
        else:
            needed = use if self._budget.alone else self._disputes.under_way.beside(use, news_take(self._view))
        alarm = not stream.information_type.markovian and (not contested or weighed.outweighs)
        room = self._budget.opens(now, use, needed, anybodys=leads or alarm)
        if leads and room > now:
            room += opening(self._view)
        opens = room if room <= until else -math.inf
        if contested or (priced and changes_plans(use, self._budget.limits)):
            opens = max(opens, self._turn(now, stream, leads=leads))
        if not stream.information_type.markovian:
            opens = min(opens, until)  # no newer one replaces it; after a freeze news are taken to take seconds
        opens = self._for_certain(now, sample, use, opens, until)
        if opens <= now:
            return False
        self._inbox.rest(sample, opens)
        self._followers.lead(kind, sample, use, opens)
        return True

    def _for_turn(self, now: float, stream: Stream, sample: Waiting, use: Amounts) -> bool:
        """Whether a sample waits for our turn, or in it for one of ours that gains more.

        As long as it is worth half of what it was: twelve robots with frames at random used 38 % of the limit where it
        waited no longer than for other room, and 44 so.
        """
        patience = max(self._disputes.patience(stream), half_life(stream.information_type.utility))
        opens = self._budget.opens(now, use)
        if opens <= now and not self._appraisal.owed(now, stream, sample) and self._gains_less(now, stream, sample):
            opens = now + TUNING.shortest_wait
        if not now < opens <= sample.t_gen + patience:
            return False
        self._inbox.rest(sample, opens)
        return True

    def _gains_less(self, now: float, stream: Stream, sample: Waiting) -> bool:
        """Whether another sample gains more that could go in our turn now, too.

        Eight robots with frames and with samples that last for 10 s reach 75 % of a central decider so, and 49 where
        the oldest goes.
        """
        gain = claim(now, stream)[0] * sample.size
        for each in self._inbox:
            other = self._appraisal.stream_of(now, each) if each.key != sample.key else None
            if other is None or claim(now, other)[0] * each.size <= gain:
                continue
            use = self._appraisal.use(other, each)
            if self._budget.by_turn(now, use) and not self._budget.lacking(now, use):
                return True
        return False

    def _for_certain(self, now: float, sample: Waiting, use: Amounts, opens: float, until: float) -> float:
        """Return when there is room at last: a small sample waits a window for others, then it has its certain part.

        Else beside a robot that claimed gigabytes, for which windows are stretched, alarms waited for 8 s.
        """
        certain = self._budget.certain_at(now, use)
        if opens > now:
            return min(opens, max(certain, sample.t_gen + shortest_window(self._budget.limits)))
        waits = now < certain <= until and not sample.markovian and bool(self._budget.lacking(now, use))
        return certain if waits else opens

    def _turn(self, now: float, stream: Stream, *, leads: bool) -> float:
        """Return when the channel is free for a stream [s]: the best claim goes first, and the others hear of it."""
        free = self._channel_free(now, stream)
        return free if leads or free <= now else free + news_take(self._view)

    def _channel_free(self, now: float, stream: Stream) -> float:
        """Return when the channel has carried what was sent so far [s]; −∞ where nobody knows what others send."""
        budget, limits = self._budget, self._budget.limits
        if budget.alone or not limits or (part := pace_part(self._view, stream, limits)) <= 0.0:
            return -math.inf
        since = now - longest_window(limits)
        return carried([*budget.own.since(since), *(s for s in budget.others(now) if s[0] >= since)], limits, part)
