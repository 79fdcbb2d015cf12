"""Equal parts, which nobody agrees on: overbooked, and what is larger goes by turns of the clock."""

import math
from collections.abc import Callable, Sequence
from heapq import nlargest
from typing import NamedTuple

from proxy.core.coordination.overbooking import Overbooking
from proxy.core.coordination.team import Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, use_of
from proxy.core.protocol.messages import tag
from proxy.core.view.peer import Amount, Peer
from proxy.core.view.view import SharedView


class Turn(NamedTuple):
    """Our turn with a message, by our clock: when it `began` [s], −∞ where a message needs none, ∞ if it is not now.

    The `next` one begins then [s]; in each there may be sent so much of the limit as a `slot`.
    """

    began: float
    next: float = math.inf
    slot: float = 1.0


NOT_NEEDED, NOT_NOW = Turn(-math.inf), Turn(math.inf)


class ClockTurns:
    """Our turns with the large messages of every shared limit, which come first; they have these `windows` [s].

    In a *cycle* by the wall clock each robot has one short turn, in the order of tags, so far apart that no window
    holds more of them than there is room for. It depends on the number of robots, rounded up, so that who misses some
    has nearly the same turns, and on the second largest messages that states tell, so that none takes the others theirs
    alone. 28 robots with cameras had 67 % of the windows over the limit without turns, and have none (broadcast).
    """

    def __init__(self, now: float, windows: Sequence[float]) -> None:
        self._windows = tuple(windows)
        self._robots, self._place = 1, 0.0
        """How many robots have turns, and which part of them come before us."""
        self._largest, self._small_counts = 1.0, 1.0
        """What part of a limit goes without a turn, and how many times it counts before one."""
        self._slots = [0] * len(self._windows)
        """How many large messages each limit has room for; 0 while nobody has any."""
        self._saved = [0.0] * len(self._windows)
        """What part of each limit is saved for a large message of ours at most."""
        self._ahead = 0.0
        """By how much the wall clock is ahead of ours [s]."""
        self._paid = [now] * len(self._windows)
        """Until when our part of each limit has paid for all that we sent [s]: else small samples beside frames had 41
        % of the windows of 28 robots over the limit."""

    def look(self, view: SharedView, limits: tuple[Limit, ...], team: Team) -> None:
        """See how large messages are, and what the wall clock says; all of the team have turns, known to send or not.

        Without turns of those that say that they have nothing to send, and without rounding, twelve robots use 0.74 of
        a limit, not 0.64; but one of ten that does not hear of another then sends in the turns of others.
        """
        own = tag(view.settings.zid)
        self._robots, self._ahead = len(team.members) + 1, view.clocks.offset
        self._place = sum(name < own for name in team.members) / self._robots
        self._largest = (TUNING.turn_parts if team.large else 1.0) / self._robots
        self._small_counts = 1.0 if team.large else TUNING.small_counts
        ours, others = _own_messages(view), [_messages(view, peer) for peer in view.peers.values()]
        for k in range(len(self._windows)):
            parts = [max(_part(limits[k], *message) for message in each) for each in (ours, *others) if each]
            part = sorted(parts)[-2 if len(parts) > 2 else -1] if parts else 0.0
            # Of a large team some messages are not known yet.
            slot = part * (TUNING.turn_size if team.large else 1.0)
            self._slots[k] = max(1, math.floor(1.0 / slot)) if slot > 0.0 else 0
            self._saved[k] = TUNING.turn_size * max(part, parts[0] if ours else 0.0)

    @property
    def needed(self) -> bool:
        """Whether messages are so much larger than an equal part that they need turns.

        Where these went whenever a robot's longer window had room six robots with frames of 0.3 limits had 43 % of the
        windows over the limit, by up to 1.7, and have 1.4 %.
        """
        return max(self._saved, default=0.0) * self._robots > TUNING.turn_parts

    def turn(self, now: float, k: int, part: float) -> Turn:
        """Return our turn with a message that takes this part of limit `k`; none is needed where that is not large."""
        if part <= self._largest or not self._slots[k]:
            return NOT_NEEDED
        window, wall = self._windows[k], now + self._ahead
        # Of few numbers, or who misses some robots would have other turns each time.
        robots = float(TUNING.turn_step ** math.ceil(math.log(self._robots, TUNING.turn_step)))
        cycle = robots * window * (1.0 + TUNING.turn_time + TUNING.turn_guard) / self._slots[k]
        began = (math.floor(wall / cycle - self._place) + self._place) * cycle
        paid = self._paid[k] + part * self._robots * window
        is_now = wall < began + TUNING.turn_time * window and now >= paid
        return Turn(began - self._ahead if is_now else math.inf, began + cycle - self._ahead, 1.0 / self._slots[k])

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """A message was sent that takes such parts of the limits."""
        for k, (use, saved, window) in enumerate(zip(uses, self._saved, self._windows, strict=True)):
            counts = use if use > self._largest else self._small_counts * use
            equal = self._robots * window
            self._paid[k] = max(self._paid[k], now - saved * equal) + counts * equal


def _own_messages(view: SharedView) -> list[Amount]:
    sized = ((stream, round(stream.sizes.mean)) for stream in view.streams.own())
    return [(size, view.subscribers.copies(stream)) for stream, size in sized if size]


def _messages(view: SharedView, peer: Peer) -> list[Amount]:
    """Return the largest messages of another robot, as its state tells."""
    planned = ((each.size, key) for key, each in peer.told.items() if each.size and view.specs.planned(key))
    return [(size, view.subscribers.copies_of(peer.robot, key)) for size, key in nlargest(TUNING.turn_told, planned)]


def _part(limit: Limit, size: int, copies: int) -> float:
    """Return what part of a limit a message of this size takes in so many copies."""
    return use_of(size, copies, (limit,))[0] / limit.limit


class EqualParts:
    """What each robot of a team has that is too large, or hears too little, to agree on parts."""

    def __init__(self, now: float) -> None:
        self.by_clock = False
        """Whether messages that are larger than an equal part go by turns that nobody agrees on."""
        self._overbooking = Overbooking(TUNING.use_deviations)
        self._turns = ClockTurns(now, ())

    def set_windows(self, now: float, windows: Sequence[float]) -> None:
        """The shared limits have these windows now [s]."""
        self._turns = ClockTurns(now, windows)

    def look(
        self, now: float, view: SharedView, limits: tuple[Limit, ...], team: Team, using: Callable[[float], float]
    ) -> None:
        """See who has parts, how large messages are, and what part is used, by `using`, of what we may."""
        self._turns.look(view, limits, team)
        self.by_clock = team.large or team.gave_up or self._turns.needed
        self._overbooking.advance(now, using(now), team.sharing)

    def rest(self) -> None:
        """Nobody has an equal part."""
        self.by_clock = False

    def part(self, team: Team) -> float:
        """Return what part of each shared limit we may use within a window."""
        return self._overbooking.factor / team.sharing

    def turn(self, now: float, k: int, part: float) -> Turn:
        """Return our turn with a message that takes this part of limit `k`."""
        return self._turns.turn(now, k, part)

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """A message was sent that uses such parts of the shared limits."""
        if self.by_clock:
            self._turns.sent(now, uses)
