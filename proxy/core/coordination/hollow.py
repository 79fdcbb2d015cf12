"""Claims of the channel that nothing comes of: whoever lies takes no more than an equal part from others after a while.

Whatever the lie, it shows at who is harmed: much of what we generate is not sent, we use less than an equal part,
others claim something, and the channel is hardly used as far as receivers confirm. Then we keep to an equal part for a
while, which is safe where the claims were true. Not where parts are configured, or where we find them due ourselves
(beside parts at 300 ms equal ones put 1.8 % of the windows over): there bids decide, and an eighth is certain
(`split/tuning.py`).
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeVar

from proxy.core.coordination.team import Team, usual_use
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, exceeds, use_of
from proxy.core.protocol.messages import tag
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Place, Stream
from proxy.core.view.view import SharedView

K = TypeVar("K", str, Place)
Sent = tuple[float, float]
"""Messages and bytes, copies counted."""


class _Claim(NamedTuple):
    """What a robot says to have sent, in all (at a time [s]) and of its streams, and what others say that came."""

    told: float
    counted: Sent
    streams: Mapping[str, tuple[int, float]]
    """By key how many messages, copies counted, and their mean size [B]."""
    came: Mapping[str, tuple[float, int]]


class _Account(NamedTuple):
    """What was sent so far: by us and, as they say, by others; of our streams, what was generated and what sent."""

    at: float
    ours: Sent
    streams: Mapping[str, tuple[int, int, float]]
    """By key, with their mean sizes [B]."""
    claims: Mapping[str, _Claim]
    plain: Mapping[Place, tuple[int, float]]
    """Of the streams of plain nodes how many messages were heard, copies counted, and their mean size [B]."""


class Hollow:
    """Finds that claims of others are hollow, from time to time, and rests on that for longer each time."""

    def __init__(self) -> None:
        self._until = -math.inf
        self._rest = TUNING.retry_time
        self._before: _Account | None = None
        self._judged = -math.inf
        """When claims were judged last, or it began [s]."""
        self._spared = Counter[str]()
        """By key, how many samples of ours were dropped since then though nothing asked anything for their room."""

    def begin_anew(self) -> None:
        """Other limits are in force: what became of claims under those before says nothing of these.

        Four robots that kept to equal parts of a limit went on to do so for a minute under one of five times as much:
        they sent a frame at once each 5 s, three limits in a window.
        """
        self._until, self._rest = -math.inf, TUNING.retry_time
        self._begin(None, -math.inf)

    def spare(self, key: str) -> None:
        """A sample of ours was dropped though nothing asked anything for its room: nobody held it back.

        Three robots whose large samples last for 10 s kept to equal parts, in which none fits, as most were worth
        nothing; they reached 72 % of a central decider on a channel that was hardly used, and reach 84 now.
        """
        self._spared[key] += 1

    def found(self, now: float) -> bool:
        """Whether we keep to an equal part, for what others claim is hollow."""
        return now < self._until

    def keeps(self, now: float, view: SharedView, limits: Sequence[Limit], team: Team) -> float:
        """Look at what became of claims; return the part that we keep to, 0 where they are not hollow."""
        if team.votes_to_split:
            self._begin(None, now)
        else:
            self._advance(now, view, limits, splits=team.splits)
        return _equal_part(view) if self.found(now) else 0.0

    def _begin(self, account: _Account | None, judged: float) -> None:
        """Look at claims from this account on, or the next where there is none; they were `judged` last then [s]."""
        self._before, self._judged = account, judged
        self._spared.clear()

    def _advance(self, now: float, view: SharedView, limits: Sequence[Limit], *, splits: bool) -> None:
        """Look at what became of claims since some windows ago, if it is time to; that the team `splits` is one."""
        shared = tuple(limit for limit in limits if limit.shared)
        if self.found(now) or not shared or not view.peers:
            self._begin(None, now)
            return
        before = self._before
        time = max(TUNING.hollow_time, TUNING.hollow_windows * max(limit.window for limit in shared))
        if before is not None and now < before.at + time:
            return
        after = _account(now, view)
        longest = max(TUNING.hollow_patience * time, _all_tell_within(view))
        # Who left does not tell what came until then, nor who came what came before: an operator's robot that began
        # anew left the cameras of four others silent for a minute. Nobody puts it off for good by coming and going.
        others = before is None or before.claims.keys() != after.claims.keys()
        if before is None or (others and now < self._judged + TUNING.hollow_put_off * longest):
            self._begin(after, self._judged)
            return
        if now < before.at + longest and not _all_told(before, after, view):
            return
        held_back = _held_back(before, after, self._spared)
        self._begin(after, now)
        if not held_back or not (splits or _claimed(before, after, now, view)):
            return
        equal = _equal_part(view)
        own = [stream for stream in view.streams.own() if stream.key in after.streams]
        if own and all(exceeds(TUNING.hollow_message * equal, usual_use(view, s, shared), shared) for s in own):
            return
        ours, every = _use(before, after, view, shared, TUNING.hollow_untold * equal)
        if ours < TUNING.hollow_own * equal and every < TUNING.hollow_use:
            self._until, self._before = now + self._rest, None
            self._rest = min(2.0 * self._rest, TUNING.longest_retry)


def _equal_part(view: SharedView) -> float:
    """Return an equal part: however many sessions have a robot's name, they are one."""
    return 1.0 / len({view.settings.robot, *(peer.name for peer in view.peers.values() if not peer.plain)})


def _account(now: float, view: SharedView) -> _Account:
    own = {
        s.key: (s.generated, s.forwarded, s.sizes.mean) for s in view.streams.own() if view.contention.competes(now, s)
    }
    claims = {name: _claim(now, peer, view) for name, peer in view.peers.items() if not peer.plain}
    plain = {s.place: _heard(s, view) for s in view.streams.plain()}
    return _Account(now, (view.traffic.messages, view.traffic.bytes), own, claims, plain)


def _claim(now: float, peer: Peer, view: SharedView) -> _Claim:
    own = view.streams.of(peer.robot)
    streams = {s.key: _heard(s, view) for s in own}
    told, *counted = peer.counted or (-math.inf, 0, 0)
    came = {**peer.came, tag(view.settings.zid): (now, peer.inbound.samples)}
    return _Claim(told, (counted[0], counted[1]), streams, came)


def _heard(stream: Stream, view: SharedView) -> tuple[int, float]:
    return stream.forwarded * view.subscribers.copies(stream), stream.sizes.mean


def _all_told(before: _Account, after: _Account, view: SharedView) -> bool:
    """Whether each robot has told since what it sent, and what came of the others."""
    for name, claim in after.claims.items():
        if claim.told < before.at:
            return False
        if any(claim.came.get(other, (-math.inf, 0))[0] < before.at for other in _receivers(name, view)):
            return False
    return True


def _all_tell_within(view: SharedView) -> float:
    """Return how long it takes until each robot has told what came of every other, if it tells one at a time [s].

    No claim waits for that longer than a minute. Of twelve robots that may tell 1.3 kB/s half had not told of the
    others after 70 s. Four of them took what others sent for hollow after 30 s, and sent at once: eleven limits in a
    window.
    """
    robots = view.members.speaking + 1
    return min(robots * view.words_take(robots), TUNING.hollow_words)


def _receivers(name: str, view: SharedView) -> list[str]:
    """Return the tags of those who may confirm what a robot sent: we, and all who have another name."""
    mine = view.peers[name].name
    return [tag(view.settings.zid), *(o for o, peer in view.peers.items() if peer.name != mine and not peer.plain)]


def _held_back(before: _Account, after: _Account, spared: Mapping[str, int]) -> bool:
    """Whether many of the bytes that our streams generated meanwhile were not sent, but for what was `spared`."""
    both = [(key, before.streams[key], now) for key, now in after.streams.items() if key in before.streams]
    generated = sum((now[0] - then[0] - spared.get(key, 0)) * now[2] for key, then, now in both)
    sent = sum((now[1] - then[1]) * now[2] for _, then, now in both)
    return generated > 0 and sent < TUNING.hollow_sent * generated


def _claimed(before: _Account, after: _Account, now: float, view: SharedView) -> bool:
    """Whether others say that they sent anything, or have anything to send: else they are not the cause."""
    known = before.claims.keys() & after.claims.keys()
    if any(after.claims[name].counted[0] > before.claims[name].counted[0] for name in known):
        return True
    return any(stream.robot != view.settings.robot for stream in view.contention.all(now))


def _use(
    before: _Account, after: _Account, view: SharedView, limits: tuple[Limit, ...], untold: float
) -> tuple[float, float]:
    """Return which part of the limit that is used most we used meanwhile, and all together as far as confirmed.

    Of whom somebody has not told what came of it so much is believed without: `untold`.
    """
    elapsed = after.at - before.at
    ours = _part(_less(after.ours, before.ours), elapsed, limits)
    plain = _part(_of_streams(before.plain, after.plain), elapsed, limits)
    every = [total + use for total, use in zip(ours, plain, strict=True)]
    for name in before.claims.keys() & after.claims.keys():
        both, receivers = (before.claims[name], after.claims[name]), _receivers(name, view)
        claimed, came = _confirmed(*both, elapsed, receivers, limits)
        lacking = any(both[1].came.get(by, (-math.inf, 0))[0] < before.at for by in receivers)
        trusted = untold if lacking else 0.0
        every = [total + max(use * came, min(use, trusted)) for total, use in zip(every, claimed, strict=True)]
    return max(ours), max(every)


def _confirmed(
    then: _Claim, now: _Claim, elapsed: float, receivers: Sequence[str], limits: tuple[Limit, ...]
) -> tuple[list[float], float]:
    """Return which part of each limit a robot says to have used, and how much of that came, as others say."""
    apart = now.told - then.told if 0.0 < now.told - then.told < math.inf else elapsed
    told = [
        (sent[0], _part(sent, since, limits))
        for sent, since in (
            (_less(now.counted, then.counted), apart),
            (_of_streams(then.streams, now.streams), elapsed),
        )
    ]
    messages, use = max(told, key=lambda each: max(each[1]))
    came = sum(max(0, now.came[by][1] - then.came[by][1]) for by in receivers if by in now.came and by in then.came)
    return use, min(1.0, came / messages) if messages > 0 else 0.0


def _less(after: Sent, before: Sent) -> Sent:
    return after[0] - before[0], after[1] - before[1]


def _of_streams(then: Mapping[K, tuple[int, float]], now: Mapping[K, tuple[int, float]]) -> Sent:
    """Return what was sent of streams meanwhile, by the mean sizes that they have now."""
    sent = [(max(0, now[key][0] - then[key][0]), now[key][1]) for key in now.keys() & then.keys()]  # some begin anew
    return sum(count for count, _ in sent), sum(count * size for count, size in sent)


def _part(sent: Sent, elapsed: float, limits: tuple[Limit, ...]) -> list[float]:
    """Return which part of each limit that uses, in the mean."""
    messages, size = sent
    if messages <= 0:
        return [0.0] * len(limits)
    each = use_of(max(0, round(size / messages)), 1, limits, own=False)
    return [messages * use * c.window / (c.limit * elapsed) for use, c in zip(each, limits, strict=True)]
