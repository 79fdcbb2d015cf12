"""The team as one robot sees it: who takes part, who has something to send, and whether the team splits the limits."""

import math
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from proxy.core.coordination.patience import Patience
from proxy.core.coordination.tuning import TUNING
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.market.standing import interval_of
from proxy.core.model.limits import Limit, allowance_of, changes_plans, exceeds, shortest_window, use_of
from proxy.core.model.settings import is_broadcast
from proxy.core.protocol.messages import Digest, StreamState
from proxy.core.split.agreement import Agreement
from proxy.core.split.split import outdoes_equal
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


class Asking(NamedTuple):
    """A stream whose messages may be sent: what one uses in all its copies, and the mean time between two [s]."""

    stream: Stream
    use: tuple[float, ...]
    interval: float


class Team:
    """Each robot votes, in its digests, for a split when it finds that one is due; one vote is enough."""

    def __init__(self, view: SharedView, now: float) -> None:
        self._view, self._began = view, now
        self.strict = view.settings.coordination == "split"
        """Whether an operator wants the team to split whatever it votes for."""
        self.members: frozenset[str] = frozenset()
        """Tags of the others that take part."""
        self._votes: set[str] = set()
        """Tags of the others that find that the team has to split."""
        self._took: deque[float] = deque(maxlen=TUNING.late_digests)
        """How long the last digests took to us [s]."""
        self._dear_since = math.inf
        """Since when announcements cost too much [s]."""
        self.votes_to_split = self.strict
        """Whether we find that the team has to split."""
        self.rhythms_known = False
        """Whether it is known how often large samples of ours come, if we have any."""
        self.had_large = False
        """Whether we have had large samples: nobody knows how often they come before they do."""
        self.undecided = False
        """Whether it is not, or we broadcast and know no way yet, and they may come seldom: the team splits so long."""
        self.seldom = False
        """Whether large samples of all come seldom, and there is no room for all of them."""
        self._splits_seldom = False
        """Whether the team splits as that is so, and news of what others send do not soon come."""
        self.rivals = False
        """Whether several robots have something to send."""
        self.must_announce = False
        """Whether others have to hear of what we send, as far as we know."""
        self.tight = False
        """Whether announcements take most of what robots may tell each other."""
        self.even = False
        """Whether equal parts do: announcements cost too much, and no message is much larger than such a part."""
        self.sharers: frozenset[str] = frozenset()
        """Tags of the others that share equal parts with us: all but those that are known to have sent nothing."""
        self.patience, self._stuck = Patience(), False
        self.gave_up = False
        """Whether the team could not agree on parts in time, and words cost too much: equal parts need none. Twelve
        robots that planned for all instead used 8 to 23 % of 0.3 Mbit/s for minutes."""
        self.varied = False
        """Whether all that takes much of a limit is of sizes that vary: what is left of it is used, however little."""
        self.splits = self.strict
        """Whether each robot has a part of every limit."""

    @property
    def agrees(self) -> bool:
        """Whether each robot plans the same for all: not where it would split, and cannot agree on parts."""
        return self.seldom and not (self._splits_seldom or self.splits)

    @property
    def begins_split(self) -> bool:
        """Whether the team is one that splits from the beginning, as far as is known."""
        return self.strict or self._splits_seldom or self.undecided or not self.rhythms_known

    @property
    def robots(self) -> int:
        """How many robots take part."""
        return len(self.members) + 1

    @property
    def large(self) -> bool:
        """Whether the team is too large to agree on parts, or to announce all to all."""
        return len(self.members) >= TUNING.large_team

    @property
    def quiet(self) -> bool:
        """Whether all have equal parts, for the team is large, or they do: nobody agrees on others."""
        return self.splits and (self.large or ((self.even or self.gave_up) and not self.strict))

    @property
    def sharing(self) -> int:
        """How many robots have equal parts then."""
        return len(self.sharers) + 1

    def set_members(self, members: Collection[str]) -> None:
        """These robots take part, and we."""
        self.members = frozenset(members)
        self._votes &= self.members
        self._conclude()

    def heard(self, digest: Digest, took: float) -> None:
        """A digest of a member came, which took so long [s]; an announcement holds no vote."""
        self._took.append(took)
        if not digest.brief:
            self.heard_vote(digest.tag, splits=digest.splits)

    def heard_vote(self, name: str, *, splits: bool) -> None:
        """A member finds that the team has to split, or does not."""
        (self._votes.add if splits else self._votes.discard)(name)
        self._conclude()

    def news_take(self, waiting: float) -> float:
        """Return what digests take from or to any robot at most, took to us lately, or are `waiting` for now [s]."""
        return max(self._view.staleness.longest_way, min(self._took, default=0.0), waiting)

    def wait(self, now: float, waiting: float, agreement: Agreement | None, window: float) -> None:
        """Robots may have yet to agree on parts; where that takes too long they do without for a while.

        So they do where they agreed on slots that cost too many words, and are not worth these. All find that at once,
        and have equal parts, whatever made them split.
        """
        pending, outdoes, costly, news = False, False, False, self.news_take(waiting)
        if agreement is not None and self.members and not self.large:
            pending, outdoes = agreement.pending, outdoes_equal(agreement)
            # The longest window of what robots share takes so long [s].
            turns = 0.0 if pending or outdoes else sum(1.0 / t.shortest(window, news) for t in agreement.turns)
            if costly := turns * self._view.words_take(self.robots) > TUNING.passed_on * self.robots:
                self.patience.give_up(now)
        self._stuck = self.patience.is_over(now, news, pending=pending, agreed=pending and outdoes)
        dear = self.gave_up or costly or self._dear_since < math.inf
        self.gave_up = self._stuck and (dear or self._view.words_take(self.robots) > TUNING.slow_words)
        self._conclude()

    def judge(
        self,
        now: float,
        limits: tuple[Limit, ...],
        waiting: float,
        announcing: Callable[[Sequence[Asking]], float],
        *,
        asked: bool,
        heeded: bool = True,
    ) -> None:
        """Find whether the team has to split; `asked`: another asks for a part; `heeded`: what others say counts."""
        view, window, still = self._view, shortest_window(limits), TUNING.hysteresis if self.votes_to_split else 1.0
        competing = view.contention.all(now)
        sending = {stream.robot for stream in competing} | _unheard(view)
        self.sharers = self.members if self.large else self._find_senders()
        sent = sendable(now, view, competing, limits)
        share, taken = announcing(sent), _parts_taken(sent, self.sharing, limits)
        # Who hears that announcements cost another one too much finds so, too, where it nearly does.
        dear = share > (TUNING.hysteresis if self._votes else still) * _affordable(taken)
        # Who sends alone keeps nothing free for those who listen: they say nothing in a team of equal parts.
        several = self.even or len(sending) > 1 or any(peer.told for peer in self._others())
        self.even = dear and several and self._equal_parts_do(competing, limits)
        # Where each has its part, digests seldom say what a robot sends, and its bid says that it does. Of equal parts
        # nobody says anything: one of four robots heard nothing of the others for 14 s, and took the whole limit.
        silent = self.even or self.gave_up
        self.rivals = asked or len(sending) > 1 or silent or view.members.speaking > TUNING.few_robots
        large = [s for s in competing if changes_plans(usual_use(view, s, limits), limits)]
        self.varied = bool(large) and all(s.sizes.deviation > TUNING.varied_sizes * s.sizes.mean for s in large)
        self._look_at_rhythms(now, limits, waiting)
        # Who has just been met may send before it can say so.
        self.must_announce = heeded and (self.rivals or bool(view.newcomers.met_lately(now)))
        self.tight = self.rivals and share > TUNING.affordable
        if not self.rivals or math.isinf(window):
            self.votes_to_split = self.strict
            self._conclude()
            return
        # Of very many that send at once each hears too late of the others, and it takes long until it knows all.
        overheard = {peer.robot for peer in self._others() if peer.overheard} if self.large else set()
        enough = min(TUNING.large_team, TUNING.most * self.robots)
        many = self.large and len(sending | overheard) >= still * enough
        # Late news harm nobody who has nothing to decide: an operator hears digests behind the frames it gets.
        # Where limits follow the channel it is a queue that makes news late, and these dissolve it.
        decides = view.settings.robot in sending and all(limit.least >= 1.0 for limit in limits)
        late = decides and self.news_take(waiting) >= still * TUNING.late_news * window
        self._dear_since = min(self._dear_since, now) if dear else math.inf
        lasting = 0.0 if self.even or view.members.speaking > TUNING.few_robots else TUNING.dear_time
        self.votes_to_split = self.strict or self._splits_seldom or late or many or now >= self._dear_since + lasting
        self._conclude()

    def _conclude(self) -> None:
        """Work out whether the team splits: each event asks for that 20 times."""
        voted = self.gave_up or (not self._stuck and (self.votes_to_split or bool(self._votes)))
        self.splits = self.strict or (self.undecided and bool(self.members)) or (self.rivals and voted)

    def _equal_parts_do(self, competing: Collection[Stream], limits: tuple[Limit, ...]) -> bool:
        """Return whether several robots send several streams each, and nothing much larger than an equal part."""
        if self.sharing < TUNING.even_robots or self._streams_each() < TUNING.even_streams:
            return False
        most = TUNING.even_parts * (1.0 if self.even else TUNING.hysteresis) / self.sharing
        return not any(exceeds(most, usual_use(self._view, stream, limits), limits) for stream in competing)

    def _find_senders(self) -> frozenset[str]:
        """Return the tags of the others that share what there is: all but those that are known to have sent nothing."""
        listens = self._view.newcomers.only_listens
        return frozenset(name for name, peer in self._view.peers.items() if name in self.members and not listens(peer))

    def _streams_each(self) -> float:
        """Return how many streams a robot has in the mean, as states tell; small ones beside others do not count."""
        robots: list[list[float]] = [[stream.sizes.mean for stream in self._view.streams.own()]]
        robots += [[each.size for each in peer.told.values()] for peer in self._others() if peer.told]
        return sum(map(_not_small, robots)) / len(robots)

    def _others(self) -> Iterator[Peer]:
        return (peer for name, peer in self._view.peers.items() if name in self.members)

    def _look_at_rhythms(self, now: float, limits: tuple[Limit, ...], waiting: float) -> None:
        """See how often large samples come: ours, and those of which the others' states tell."""
        sizes = ((stream, usual_use(self._view, stream, limits)) for stream in self._view.streams.own())
        uses = [(stream, use) for stream, use in sizes if changes_plans(use, limits)]
        own = [stream for stream, _ in uses]
        known = all(stream.schedule.period for stream in own)
        began = max((stream.began for stream in own), default=self._began)
        if own and not self.had_large:
            self.had_large, self.rhythms_known = True, False
        self.rhythms_known |= now >= began + TUNING.rhythm_time or (known and any(self._view.streams.own()))
        # Not where limits follow the channel, nor where samples are overheard and news soon come: ten robots that
        # broadcast equal messages would reach 0 to 5 % less at 20 ms, and 16 to 24 % less where 30 % is lost.
        apt, broadcast = all(limit.least >= 1.0 for limit in limits), is_broadcast(self._view.settings.transport)
        heard = self._view.staleness.known or now >= began + TUNING.ways_time
        begins = apt and not (heard if broadcast else self.rhythms_known) and not self._others_plan_for_all()
        soon = TUNING.overheard_news if broadcast else TUNING.announced_news
        still = TUNING.hysteresis if self._splits_seldom else 1.0
        late = self.news_take(waiting) >= still * soon * shortest_window(limits)
        late |= not (broadcast or _may_announce(self._view, self.robots, limits))
        self.undecided = begins and not any(exceeds(TUNING.seldom_size, use, limits) for _, use in uses)
        if not (own and known and apt):
            self.seldom = self._splits_seldom = False
            return
        period = max(stream.schedule.period for stream in own)
        large = [(s.schedule.kind, s.schedule.period, use) for s, use in uses]
        told = ((each.schedule, each.period or period, use) for each, use in _told(self._view, limits, one=self.large))
        large += [each for each in told if changes_plans(each[2], limits)]
        asked = [sum(use[k] * c.window / period for _, period, use in large) / c.limit for k, c in enumerate(limits)]
        least = TUNING.seldom_period * shortest_window(limits)
        self.seldom = max(asked, default=0.0) > 1.0 and all(
            kind != MEMORYLESS and period >= least and not exceeds(TUNING.seldom_size, use, limits)
            for kind, period, use in large
        )
        self._splits_seldom = self.seldom and late

    def _others_plan_for_all(self) -> bool:
        """Whether a robot that knows its rhythms finds no split due: who joins it does as it does."""
        told = ((name, each) for name, peer in self._view.peers.items() for each in peer.told.values())
        return any(each.period > 0.0 and name not in self._votes for name, each in told)


def _told(view: SharedView, limits: tuple[Limit, ...], *, one: bool) -> Iterator[tuple[StreamState, tuple[float, ...]]]:
    """Yield the streams that the others' states tell of, and what their messages use, in `one` copy or in all.

    In a large team it would take seconds to find who wants thousands of keys.
    """
    for peer in view.peers.values():
        for key, each in peer.told.items():
            if view.specs.planned(key):
                copies = 1 if one else view.subscribers.copies_of(peer.robot, key)
                yield each, use_of(each.size, copies, limits)


def _not_small(sizes: Sequence[float]) -> int:
    """Return how many streams are not small beside the largest."""
    least = TUNING.even_size * max(sizes, default=0.0)
    return sum(size >= least for size in sizes)


def _may_announce(view: SharedView, robots: int, limits: tuple[Limit, ...]) -> bool:
    """Whether a team of so many robots may announce each of its seldom samples in unicast: what they say is little."""
    if robots > TUNING.announcing_robots:
        return False
    told = allowance_of(view.specs, view.settings.allowance, robots)
    words = ((use_of(round(told * limit.window), 1, (limit,)), limit) for limit in limits)
    return not any(exceeds(TUNING.announced_part, use, (limit,)) for use, limit in words)


def _parts_taken(sending: Iterable[Asking], robots: int, limits: tuple[Limit, ...]) -> float:
    """Return how many equal parts of so many robots a message takes, in the mean over what streams ask for.

    In one copy: with all of them a team of twelve announces that had 15 points more in parts, and no window over.
    """
    taken, asked = 0.0, 0.0
    for stream, _, interval in sending:
        use = use_of(round(stream.sizes.mean), 1, limits)
        part = max([u / c.limit for u, c in zip(use, limits, strict=True) if c.shared], default=0.0)
        asks = part / interval
        taken, asked = taken + asks * part * robots, asked + asks
    return taken / asked if asked else 0.0


def sendable(now: float, view: SharedView, streams: Collection[Stream], limits: tuple[Limit, ...]) -> list[Asking]:
    """Return the streams whose messages, in all copies, fit into every limit, or were sent lately all the same.

    What is never sent is never announced: four robots with odometry on 50 kbit/s, whose frames are larger than it lets
    pass at all, took announcing for cheap, waited for it, and used a quarter of the limit.
    """
    found, window = list[Asking](), shortest_window(limits)
    since = now - TUNING.stretched_windows * window
    for stream in streams:
        use = usual_use(view, stream, limits)
        if (stream.sent is not None and stream.sent.t_sent >= since) or not exceeds(1.0, use, limits):
            found.append(Asking(stream, use, interval_of(view.staleness.known_until(now, stream), stream, window)))
    return found


def _affordable(taken: float) -> float:
    """Return which part of the allowance announcements may take where messages take so many equal parts."""
    if taken > 1.0:
        return TUNING.affordable_turns
    return min(
        TUNING.affordable_at_most, TUNING.affordable + TUNING.affordable_few * max(0.0, taken - TUNING.many_to_a_part)
    )


def usual_use(view: SharedView, stream: Stream, limits: tuple[Limit, ...]) -> tuple[float, ...]:
    """Return what a usual message of the stream uses of each limit in all its copies."""
    return use_of(round(stream.sizes.mean), view.subscribers.copies(stream), limits)


def _unheard(view: SharedView) -> set[str]:
    """Return the robots that have streams, as their states say, of which no digest has said anything yet."""
    known = {stream.robot for stream in view.streams}
    new = (peer for peer in view.peers.values() if peer.robot not in known and not peer.plain)
    return {peer.robot for peer in new if any(view.specs.planned(key) for key in peer.told)}
