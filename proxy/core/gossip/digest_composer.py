"""What is in a digest of ours, and in an announcement."""

from dataclasses import replace

from proxy.core.congestion.channel import Capacity
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.digest_budget import EchoBudget
from proxy.core.gossip.state_announcements import StateAnnouncements
from proxy.core.gossip.stream_news import StreamNews
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, Echo, StreamDigest, tag
from proxy.core.view.stream import usual_scale
from proxy.core.view.view import SharedView


class DigestComposer:
    """Makes digests out of what the parts of the core have to tell."""

    def __init__(
        self,
        view: SharedView,
        coordination: Coordination,
        capacity: Capacity,
        *,
        news: StreamNews,
        echoes: EchoBudget,
        states: StateAnnouncements,
    ) -> None:
        self._view = view
        self._coordination = coordination
        self._capacity = capacity
        self._news = news
        self._echoes = echoes
        self._states = states

    def digest(self, now: float, copies: int, *, only_parts: bool) -> Digest:
        """Return a digest that goes out now in so many copies; with `only_parts` without news of streams and echoes."""
        streams = () if only_parts else self._news.take(now, list(self._view.streams.own()))
        digest = Digest(
            robot=self._view.settings.robot,
            tag=tag(self._view.settings.zid),
            sent=now,
            messages=self._view.traffic.messages,
            bytes=self._view.traffic.bytes,
            streams=streams,
            state=self._states.state.number,
            capacity=self._capacity.report(now),
            splits=self._coordination.team.votes_to_split,
            split=self._coordination.announcement(now),
            partial=only_parts or self._news.left,
        )
        if only_parts and not self._view.settings.digests_on_air:
            return digest
        return replace(digest, echoes=self._take_echoes(now, copies, len(pack_digest(digest))))

    def announcement(self, now: float, streams: tuple[StreamDigest, ...]) -> Digest:
        """Return the announcement of what streams sent, without features and without what is as usual."""
        sizes = {each.id: each.size for each in self._states.state.streams}
        own = {stream.id: stream for stream in self._view.streams.own()}
        return Digest(
            robot=self._view.settings.robot,
            tag=tag(self._view.settings.zid),
            sent=now,
            streams=tuple(brief(each, sizes.get(each.id, 0), usual_scale(own[each.id])) for each in streams),
            state=self._states.state.number,
            brief=True,
        )

    def _take_echoes(self, now: float, copies: int, size: int) -> tuple[Echo, ...]:
        """Return echoes for a digest of `size` bytes; if limits follow the channel they tell how long digests wait."""
        quickest = not self._capacity.factors
        echoes = self._echoes.take(now, self._view.echoes.due(now, quickest=quickest), copies, size)
        self._view.echoes.sent(echo.peer for echo in echoes)
        return echoes


def brief(news: StreamDigest, size: int, scale: float) -> StreamDigest:
    """Return an announcement of a stream that is so large and worth so much as a rule."""
    said = -1.0 if news.scale == scale else news.scale
    plain = replace(news, scale=said, features=())
    return replace(plain, size=0) if news.size == size and said < 0.0 else plain
