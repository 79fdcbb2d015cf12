"""Robots that have other limits, or say nothing that is understood: no team waits for them, and operators are told."""

import math
from collections.abc import Iterable, Mapping, Sequence

from proxy.core.model.limits import fingerprint
from proxy.core.protocol.envelope import READABLE, VERSION
from proxy.core.view.peer import Peer
from proxy.core.view.streams import Streams
from proxy.core.view.tuning import TUNING
from utility_specs import Specs


class MismatchedLimits:
    """The robots that take no part, by their tags."""

    def __init__(self, peers: Mapping[str, Peer], streams: Streams) -> None:
        self._peers = peers
        self._table = streams
        self._since: dict[str, float] = {}
        """Since when robots have had other limits [s]."""
        self._look_at = 0.0
        self.found: frozenset[str] = frozenset()
        self._early: frozenset[str] = frozenset()
        """Those of them that have been silent for so short that nobody need be told."""

    def heard(self, name: str) -> None:
        """A digest or a state of a robot was understood: its first word lets it take part."""
        if name in self.found:
            self._look_at = -math.inf
        if name in self._early:
            self._peers[name].take_part(plain=False)

    def met(self, name: str, peer: Peer) -> None:
        """A robot came; where others came without a word it takes no part before its first."""
        if peer.plain:
            self.found |= {name}
            self._early |= {name}

    @property
    def worth_a_warning(self) -> frozenset[str]:
        """Those of which an operator is told."""
        return self.found - self._early

    def look(self, now: float) -> bool:
        """Look who has taken no part for too long; return whether these are others than before."""
        if now < self._look_at:
            return False
        self._look_at, peers = now + TUNING.mismatch_check, self._peers
        alike = (0, fingerprint(self._table.specs))  # who says nothing of its limits may have the same
        self._since = {
            name: self._since.get(name, now) for name, peer in peers.items() if peer.state.limits not in alike
        }
        for peer in peers.values():
            peer.take_part(plain=self._not_understood(now, peer))
        more = max(0, len(peers) - TUNING.telling_robots)
        patience = TUNING.agreement_time + TUNING.telling_per_robot * more
        apart = {name for name, since in self._since.items() if now - since > patience}
        before, self.found = self.found, frozenset(apart | {name for name, peer in peers.items() if peer.plain})
        self._early = frozenset(
            name
            for name, peer in peers.items()
            if peer.plain and peer.silent and not (_foreign(peer) or self._met_before(now, peer, TUNING.agreement_time))
        )
        return self.found != before

    def warnings(self, among: Iterable[str] | None = None) -> list[str]:
        """Name them all, or those `among` these: in one line where the same is wrong with several."""
        found, alike = self.worth_a_warning if among is None else self.found.intersection(among), dict[str, list[str]]()
        for name, peer in self._peers.items():
            if name in found:
                alike.setdefault(self._fault(peer), []).append(peer.robot)
        return [f"robot {first} {fault}{_so_with(others)}" for fault, (first, *others) in alike.items()]

    def _not_understood(self, now: float, peer: Peer) -> bool:
        if peer.digest is not None:
            return now - peer.digest_received > TUNING.understood_for
        if peer.announced:
            return now - peer.since > TUNING.understood_for
        if _foreign(peer) or (peer.silent and peer.plain):
            return True
        time = TUNING.word_time if peer.silent else TUNING.agreement_time
        return self._met_before(now, peer, time)

    def _met_before(self, now: float, peer: Peer, time: float) -> bool:
        """Whether a robot was met longer ago than this time, and what so many robots take besides [s]."""
        return now - peer.since > time + TUNING.agreement_per_robot * len(self._peers)

    def _fault(self, peer: Peer) -> str:
        if not peer.plain:
            there, here = (_named(each) for each in (peer.state.specs, self._table.specs.generation))
            return (
                f"has other limits (specs {there}, here {here}): nothing keeps what it sends and what others send "
                "within either; give all robots the same constraints"
            )
        if _foreign(peer):
            return (
                f"runs another version of Sendworthy: daemons there speak version {peer.wire} of what they tell each "
                f"other, here {VERSION}; {_APART}; install one version on all robots"
            )
        return (
            f"is on the mesh, but nothing is heard of it that a daemon would say; {_APART}; look at its log and at "
            "what may keep its messages from crossing"
        )


_APART = "it takes no part, and nothing keeps what it sends and what others send within the limits"
_NAMED = 8
"""So many robots beside the first are named."""


def _so_with(others: Sequence[str]) -> str:
    """Say of whom the same is true: a robot without specs had a line for each other one."""
    if not others:
        return ""
    more = f" and {len(others) - _NAMED} more" if len(others) > _NAMED else ""
    return f" (the same with {', '.join(others[:_NAMED])}{more})"


def _named(generation: str) -> str:
    return "none" if generation == Specs.empty().generation else generation


def _foreign(peer: Peer) -> bool:
    return bool(peer.wire) and peer.wire not in READABLE
