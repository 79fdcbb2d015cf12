"""Epochs: who leads, so that one robot at a time lends what all share.

An epoch is a term, and a hash of who leads and of the limits. A robot enters the greatest epoch it hears of whose
leader it knows; from then on it holds nothing of before, and it does not say that it is there until what it sent has
left the windows. So who leads may lend as soon as all say that they follow; only for what robots that are gone may have
sent it waits for one window more. The leader stays until it is gone; then the robot with the least tag leads, in the
next term. A robot that meets nobody leads itself in term 0, which gives way to every other one; when it meets somebody
it waits for them as others do.
"""

import math
from collections.abc import Callable, Iterable
from functools import reduce
from zlib import crc32

from proxy.core.limits import Limit

NEWCOMERS = 4
"""So many robots may be new to all others at the same time: each has that part of the floor."""
EDGE = 1e-3
"""What one robot lends, the next one may use so much later [s]: windows are closed, and times are rounded."""
TERMS = 1 << 20
"""Terms are counted up to here, and then from 1 again."""
ANSWERS = 2.5
"""Who met others waits for who leads them to speak, by so many times the time it took to meet them..."""
LONGEST_WAIT = 4.0
"""... and no longer than this [s]."""


def later(epoch: int, other: int) -> bool:
    """Whether another epoch gives way to this one: terms go round, and term 0 comes before all others."""
    term, before = epoch >> 32, other >> 32
    ahead = (term - before) % TERMS
    return epoch > other if not (term and before and ahead) else ahead < TERMS // 2


class Epochs:
    """Our epoch, and who is in which. Peers are named by their tags.

    `turned` is called when what was lent before counts no more, `left_at` tells when what we sent until now has left
    the windows that robots share [s].
    """

    def __init__(
        self,
        own: str,
        limits: tuple[Limit, ...],
        *,
        settled_at: float,
        started: float | None = None,
        turned: Callable[[], None],
        left_at: Callable[[float], float],
    ) -> None:
        self.own = own
        self.epoch = 0
        self.leader = ""
        """Who lends in our epoch; nobody while empty."""
        self.leads = False
        """Whether it is we who lend."""
        self.members: frozenset[str] = frozenset((own,))
        """Tags of the robots that share, our own included."""
        self._limits = limits
        self._started = settled_at if started is None else started
        self._settled_at = settled_at
        self._turned = turned
        self._left_at = left_at
        self._said: dict[str, int] = {}
        """In which epoch each robot says it is."""
        self._behind: list[str] | None = None
        """Who does not say that it is in ours; None: to be looked for."""
        self._awaited: set[str] = set()
        self._ready_at = 0.0
        self._lost_at = -math.inf
        """When a robot was last found gone [s]."""
        self._next = (0, "")
        """The epoch that we enter at `_enters_at`, and who leads it; nobody any more while empty."""
        self._enters_at = 0.0

    @property
    def stragglers(self) -> list[str]:
        """Robots that are not known to be in our epoch."""
        if self._behind is None:
            self._behind = sorted(m for m in self.members if m != self.own and self._said.get(m) != self.epoch)
        return self._behind

    def confirmed(self, now: float) -> bool:
        """Whether somebody lends; if it is we, whether we may."""
        return self.leader in self.members and (not self.leads or (not self._awaited and now >= self._ready_at))

    def due_at(self, now: float) -> float:
        """When time alone changes something [s]."""
        times = [self._enters_at] if self._next[1] else []
        return min((t for t in (*times, self._ready_at if self.leads else now) if t > now), default=math.inf)

    def knows(self, epoch: int, names: Iterable[str]) -> bool:
        """Whether an epoch is one of our limits, with one of these robots, or us, as the one who leads."""
        number = epoch & 0xFFFFFFFF
        return not epoch or epoch == self.epoch or any(self._hash(name) == number for name in (self.own, *names))

    def set_members(self, now: float, members: Iterable[str]) -> None:
        """The robots on the mesh are now these (ours is added)."""
        before, self.members, self._behind = self.members, frozenset(members) | {self.own}, None
        if len(before) == 1 < len(self.members) and not self.epoch:
            wait = min(LONGEST_WAIT, ANSWERS * max(0.0, now - self._started))
            self._settled_at = max(self._settled_at, now + wait)
        if before - self.members:
            self._lost_at = now
        if self.leads and self._awaited - self.members:
            self._ready_at = max(self._ready_at, now + self._window())
        # Of whom we do not know yet we must not assume that they follow, unless others already do.
        ready = len(before) > 1 and not self._awaited and now >= self._ready_at
        self._awaited = (self._awaited & self.members) | (set() if ready else set(self.members - before))
        self.look(now)

    def set_limits(self, now: float, limits: tuple[Limit, ...], *, free: bool) -> None:
        """The constraints are now these; other ceilings need another epoch. `free`: nothing is lent."""
        before, self._limits = self._ceilings(), limits
        if before == self._ceilings():
            return
        alone = self.leads and free and len(self.members) == 1
        self._follow("")
        if self.epoch:
            self._seek(now, again=True)
        if alone:
            self._ready_at = now

    def heard(self, now: float, peer: str, epoch: int) -> bool:
        """Take in that `peer` is in `epoch`; return whether it leads us there."""
        if peer not in self.members:
            return False
        if self._said.get(peer) != epoch:
            self._said[peer], self._behind = epoch, None
        if later(epoch, self.epoch) and later(epoch, self._next[0]) and (leader := self._leader_of(epoch)):
            if leader == self.own:
                self._propose(now, epoch)
            else:
                self._leave(now, epoch, leader)
        if self.leads:
            self._confirm(peer, epoch)
        self.look(now)
        return not self.leads and epoch == self.epoch and peer == self.leader

    def forget(self, peer: str) -> None:
        """A robot left: what it last said of its epoch no longer counts."""
        self._said.pop(peer, None)
        self._behind = None

    def look(self, now: float) -> None:
        """Enter the epoch that we wait for, and lead if nobody does."""
        epoch, leader = self._next
        if leader and leader not in self.members:
            self._next = (epoch, "")
        elif leader and now >= self._enters_at:
            self._enter(epoch, leader)
        self._seek(now)

    def _seek(self, now: float, *, again: bool = False) -> None:
        """Lead, if nobody does whom we know of and it falls to us: to the least tag of those who are there."""
        if (self.leader in self.members and not again) or now < self._settled_at or self.own != min(self.members):
            return
        others = self.members - {self.own}
        said = [self._said.get(other, 0) for other in others]
        led = any(self._leader_of(epoch) in others for epoch in said if not later(self.epoch, epoch))
        if not (led or self._next[1]) and (
            all(other in self._said for other in others) or not any(self._said.values())
        ):
            known = (self._next[0], *self._said.values())
            self._propose(now, reduce(lambda last, each: each if later(each, last) else last, known, self.epoch))

    def _propose(self, now: float, before: int) -> None:
        """Lead in the term after an epoch."""
        alone = len(self.members) == 1 and not before
        term = 0 if alone else (before >> 32) % TERMS + 1
        self._enter(term << 32 | self._hash(self.own), self.own)
        self._awaited = set(self.members - {self.own})
        quiet = not before and len(self.members) <= NEWCOMERS
        self._ready_at = max(now, self._lost_at + self._window()) if quiet else now + self._window()

    def _confirm(self, peer: str, epoch: int) -> None:
        """As leader, note whether a robot follows us."""
        if epoch == self.epoch:
            self._awaited.discard(peer)
        elif epoch:
            self._awaited.add(peer)

    def _leave(self, now: float, epoch: int, leader: str) -> None:
        """Hold nothing any more, and enter an epoch when what we sent has left the windows."""
        self._next, self._enters_at = (epoch, leader), self._left_at(now) if self.epoch else now
        self._follow("")

    def _enter(self, epoch: int, leader: str) -> None:
        self.epoch, self._next, self._behind = epoch, (0, ""), None
        self._follow(leader)

    def _follow(self, leader: str) -> None:
        self.leader, self.leads, self._awaited = leader, leader == self.own, set()
        self._turned()

    def _window(self) -> float:
        return max((limit.window for limit in self._limits if limit.shared), default=0.0) + EDGE

    def _leader_of(self, epoch: int) -> str:
        """Who of those we know leads an epoch under the limits as we know them; empty when nobody does."""
        number = epoch & 0xFFFFFFFF
        return next((m for m in sorted(self.members) if epoch and self._hash(m) == number), "")

    def _hash(self, leader: str) -> int:
        return crc32(f"{leader}|{self._ceilings()}".encode())

    def _ceilings(self) -> str:
        return ",".join(f"{c.name}:{c.window!r}:{c.measure!r}" for c in self._limits if c.shared)
