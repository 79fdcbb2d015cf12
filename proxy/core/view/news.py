"""What digests tell of the streams of another robot."""

from dataclasses import replace

from proxy.core.forecast import rhythm_report
from proxy.core.protocol.messages import Digest, StreamDigest, StreamState
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Generated, Sent, Stream, usual_scale
from proxy.core.view.streams import Streams
from proxy.core.view.subscribers import Subscribers
from proxy.core.view.traffic import TrafficLog
from proxy.core.view.tuning import TUNING


class News:
    """Takes in news of streams; `own` is our tag."""

    def __init__(self, own: str, streams: Streams, subscribers: Subscribers, traffic: TrafficLog) -> None:
        self._tag = own
        self._streams = streams
        self._subscribers = subscribers
        self._traffic = traffic

    def take(self, now: float, peer: Peer, digest: Digest) -> None:
        """A digest of a peer came."""
        until = min(peer.offset.ours(digest.sent), now)
        for each in digest.streams:
            key = peer.keys.get(each.id)
            if key is None:
                self._postpone(now, peer, each)
            else:
                self._take(now, peer, key, each, until, counts=True)

    def take_state(self, now: float, peer: Peer) -> None:
        """A peer announced its state: what it says of its streams holds, and news that waited for keys is taken in.

        That does not count for losses (17 % seemed lost where all came). A stream with another number than before
        counts from 1: else 96 % of the windows of two robots were over the limit until it had caught up.
        """
        for key, told in peer.told.items():
            stream = self._streams.known(peer.robot, key)
            if stream is not None and stream.id not in (0, told.id):
                self._streams.forget(stream)
            elif stream is not None:
                stream.assume(told)
        named = peer.pending.named(peer.keys)
        self._traffic.retract([entry for _, entry in named if entry is not None])
        for news, _ in named:
            until = min(peer.offset.ours(news.t_generated), now)
            self._take(now, peer, peer.keys[news.id], news, until, counts=False)

    def _postpone(self, now: float, peer: Peer, news: StreamDigest) -> None:
        """Keep news of a stream whose key is not known yet; what was sent counts as if one robot wanted it."""
        more = peer.pending.keep(news)
        # Not if it does not say how large it was, or was heard from the air.
        if more and news.size and not self._subscribers.overhears(peer.robot):
            entry = self._traffic.note_unknown(min(peer.offset.ours(news.t_forwarded), now), news.size, peer.robot)
            peer.pending.count(news.id, entry)

    def _take(self, now: float, peer: Peer, key: str, news: StreamDigest, until: float, *, counts: bool) -> None:
        """Take in news of a stream `until` then [s]. Whether what came of it by now `counts` beside what was sent."""
        stream = self._stream_of(now, peer.robot, key, news, until)
        if stream is None:
            return
        gets_all = self._subscribers.broadcasts(peer.robot) or self._tag in self._subscribers.of(stream)
        peer.inbound.heard_news(now, key, news, counts=counts and gets_all)
        told = peer.told.get(key)
        if told is not None:
            stream.assume(told)
        t_gen = min(peer.offset.ours(news.t_generated), now)
        before, kind = stream.last, stream.information_type
        # Announcements leave features out, and what is as usual.
        features = kind.heard(news.features) if news.features or before is None else before.features
        news, rhythm = _completed(stream, news, told), rhythm_report.decoded(news, peer.offset.ours)
        last = Generated(t_gen, news.size, news.scale, features)
        stream.note_generated(news.generated, last, told=rhythm)
        t_sent = peer.offset.ours(news.t_forwarded)
        heard = stream.sent is not None and t_sent < stream.sent.t_sent + TUNING.same_sample
        stream.number(now, news.forwarded, heard=heard)
        if news.forwarded > stream.forwarded:
            self._traffic.note_sent(stream, news.forwarded, _last_sent(news, t_sent, last, before))

    def _stream_of(self, now: float, robot: str, key: str, news: StreamDigest, until: float) -> Stream | None:
        """Return the stream that news is of; None where it tells of less than is known, which may have been forged."""
        known = self._streams.known(robot, key)
        if known is not None and news.generated < known.generated:
            if now < known.known_until + TUNING.implausible_for:
                return None
            self._streams.forget(known)
        return self._streams.touch(until, robot, key, news.id)


def _completed(stream: Stream, news: StreamDigest, told: StreamState | None) -> StreamDigest:
    """Return news with what an announcement leaves out because it is as usual."""
    if news.size and news.scale >= 0.0:
        return news
    size = news.size or (told.size if told is not None else stream.newest.size if stream.last else 0)
    return replace(news, size=size, scale=news.scale if news.scale >= 0.0 else usual_scale(stream))


def _last_sent(news: StreamDigest, t_sent: float, last: Generated, before: Generated | None) -> Sent:
    """What a stream last sent, as far as news tell: the last one generated, or if that came later the one before."""
    like = last if news.t_forwarded >= news.t_generated or before is None else before
    return Sent(t_sent, t_sent, like.size, like.scale, like.features, told=True)
