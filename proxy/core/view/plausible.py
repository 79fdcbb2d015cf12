"""What a robot may say of itself: messages in another robot's name, and nonsense, are refused.

A message changes no more than an honest robot's could, and what a forged one changed does not last: when nothing has
followed from a digest, or a stream's count (`news.py`), for a while, robot or stream count as new.
"""

from collections.abc import Callable

from proxy.core.protocol.messages import Digest, State, StreamDigest
from proxy.core.view.peer import Peer
from proxy.core.view.stream import Stream
from proxy.core.view.tuning import TUNING


def objection(now: float, peer: Peer, digest: Digest, known: Callable[[StreamDigest], Stream | None]) -> str:
    """Return what is wrong with a peer's digest, or nothing; `known` finds the stream that news is of."""
    if digest.robot != peer.name:
        return "digest:forged"
    latest = digest.sent + TUNING.digest_ahead
    for news in digest.streams:
        if news.t_generated > latest or news.t_forwarded > latest:
            return "digest:time"
    for news in digest.streams:
        if news.generated > TUNING.fastest_count * TUNING.count_burst and _leaps(now, news, known(news)):
            return "digest:counts"
    if peer.digest is None or now - peer.digest_received > TUNING.implausible_for:
        return ""
    return _does_not_follow(peer.digest, now - peer.digest_received, digest) or _miscounts(now, peer, digest)


def is_old(now: float, peer: Peer | None, sent: float) -> bool:
    """Whether a digest that was sent then by a robot has been heard before, or a later one has. From any thread."""
    last = None if peer is None else peer.digest
    if last is None or peer is None:
        return False
    return now - peer.digest_received <= TUNING.implausible_for and sent <= last.sent


def _does_not_follow(last: Digest, elapsed: float, digest: Digest) -> str:
    """Say why a digest cannot come so long after the one before."""
    if digest.sent <= last.sent:
        return "digest:old"
    if digest.sent - last.sent > elapsed + TUNING.digest_delay:
        return "digest:time"
    return ""


def _miscounts(now: float, peer: Peer, digest: Digest) -> str:
    """Say if a digest cannot count what it does, after what its robot counted before."""
    if digest.brief or peer.counted is None or now - peer.counted[0] > TUNING.implausible_for:
        return ""
    elapsed, messages, size = now - peer.counted[0], digest.messages - peer.counted[1], digest.bytes - peer.counted[2]
    time = elapsed + TUNING.count_burst
    fits = 0 <= messages <= TUNING.fastest_count * time and 0 <= size <= TUNING.fastest_bytes * time
    return "" if fits else "digest:counts"


def objection_to_state(peer: Peer, state: State) -> str:
    """Return what is wrong with a peer's state, or nothing. One that a digest speaks of may be older than ours."""
    if state.robot != peer.name or state.zid != peer.zid:
        return "state:forged"
    named = peer.digest is not None and state.number == peer.digest.state
    return "state:old" if 0 < state.number < peer.state.number and not named else ""


def _leaps(now: float, news: StreamDigest, stream: Stream | None) -> bool:
    """Whether more was generated since the last news than any app could publish."""
    if stream is None or stream.generated == 0:
        return False
    time = max(0.0, now - stream.known_until) + TUNING.count_burst
    return news.generated - stream.generated > TUNING.fastest_count * time
