"""What counts against the limits: our own sends, and what we know others to have sent."""

from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from itertools import islice
from operator import itemgetter

from proxy.core.coordination.tuning import TUNING
from proxy.core.market.room import SendLog
from proxy.core.market.tuning import TUNING as MARKET
from proxy.core.model.limits import Limit, Send, is_bulky, longest_window, use_of
from proxy.core.view.traffic import WORDS
from proxy.core.view.view import SharedView


class OwnSends(SendLog):
    """Our sends, by what they use of each limit in force."""

    def __init__(self) -> None:
        super().__init__()
        self.bulky = SendLog()
        """Of these, messages for which windows may be stretched."""
        self._leaving: dict[int, Send] = {}
        """Of these, large samples that the mesh has not taken yet."""
        self.leave_after = 0.0
        """How long after their decision large samples leave, at most, as far as the last ones say [s]."""

    def renumber(self, places: Sequence[int | None]) -> None:
        """New limits are in force, which were at these places before; nothing was used of those that are new."""
        for log in (self, self.bulky):
            log.replace([(t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in log])
        self._leaving.clear()

    def begin_anew(self, parts: Sequence[float], limits: Sequence[Limit]) -> None:
        """Limits are others: of what was sent before, such a part of its use counts against each."""
        self.replace([(t, _part(use, parts)) for t, use in self])
        bulky = [(t, _part(use, parts)) for t, use in self.bulky]
        self.bulky.replace([send for send in bulky if is_bulky(send[1], limits)])
        self._leaving = {sample: (t, _part(use, parts)) for sample, (t, use) in self._leaving.items()}

    def note(self, now: float, use: tuple[float, ...], large: int | None, *, bulky: bool = False) -> None:
        """A message is sent now, a `large` sample or something else; `bulky`: windows may be stretched for it."""
        self.add(now, use)
        if bulky:
            self.bulky.add(now, use)
        if large is not None:
            self._leaving[large] = now, use

    def forget(self, before: float) -> None:
        """Of what was sent before this nothing counts any more."""
        super().forget(before)
        self.bulky.forget(before)

    def is_leaving(self, sample: int) -> bool:
        """Whether a sample is a large one that the mesh has not taken yet."""
        return sample in self._leaving

    def handed(self, now: float, sample: int) -> None:
        """The mesh took a sample: a large one counts from now on (else a window in four held up to 1.31 limits)."""
        send = self._leaving.pop(sample, None)
        if send is not None and self.remove(send):
            self.add(now, send[1])
            if self.bulky.remove(send):
                self.bulky.add(now, send[1])
            took, weight = now - send[0], TUNING.departure_weight
            self.leave_after = min(
                max(took, (1.0 - weight) * self.leave_after + weight * took), MARKET.longest_departure
            )

    def refused(self, sample: int) -> None:
        """The mesh did not take a sample."""
        self._leaving.pop(sample, None)


class OthersSends:
    """What others sent, by what it uses of each limit in force.

    What nobody decides on counts as far as it leaves the specs' `floor` of a limit, together with what of ours nobody
    decides on: a robot in `shadow` that sent 2.4 limits left none of 5 poses a second to the five others.
    """

    def __init__(self, view: SharedView) -> None:
        self._view, self._traffic = view, view.traffic
        self._decided, self._undecided, self._ours = SendLog(), SendLog(), OwnSends()
        """Others' sends, by whether anybody decided on them, and what of ours counts that nobody did."""
        self._bulky = SendLog()
        """Of those that somebody decided on, messages for which windows may be stretched."""
        self._limits: tuple[Limit, ...] = ()
        self._earlier: deque[tuple[float, Sequence[float]]] = deque(maxlen=TUNING.remembered_limits)
        """When limits became others [s], and which part of the use of what was sent before counts against each now."""
        self._taken = 0, 0
        """How many sends there were so far, and how many had been retracted."""

    def renumber(self, places: Sequence[int | None]) -> None:
        """New limits are in force, which were at these places before."""
        self._ours.renumber(places)
        for place, (at, parts) in enumerate(self._earlier):
            self._earlier[place] = at, [0.0 if k is None else parts[k] for k in places]

    def begin_anew(self, now: float, parts: Sequence[float], limits: Sequence[Limit]) -> None:
        """Limits are others from now on: of what was sent before, such a part of its use counts against each."""
        self._ours.begin_anew(parts, limits)
        for place, (at, before) in enumerate(self._earlier):
            self._earlier[place] = at, _part(before, parts)
        self._earlier.append((now, parts))
        self._limits = ()

    def use(self, now: float, use: tuple[float, ...], limits: tuple[Limit, ...]) -> None:
        """Something of ours that nobody decides on is sent now, and counts as this."""
        self._ours.forget(now - 2.0 * longest_window(limits))
        self._ours.add(now, use)

    def used(self, since: float, k: int, limits: tuple[Limit, ...], windows: float = 1.0) -> float:
        """Return what counts of a limit since then, about so many windows ago."""
        undecided = self.undecided(since, k, limits, windows)
        if not self._decided:
            return undecided
        for log in (self._decided, self._bulky):  # no window is longer than what is remembered
            log.forget(since - self._traffic.remembered(longest_window(limits)))
        return self._decided.used(since, k) + undecided

    def undecided(self, since: float, k: int, limits: tuple[Limit, ...], windows: float = 1.0) -> float:
        """Return what counts of it that nobody decided on."""
        self._follow(limits)
        if not self._undecided:
            return 0.0
        self._undecided.forget(since - self._traffic.remembered(longest_window(limits)))
        return min(self._undecided.used(since, k), self._room(since, k, windows * limits[k].limit))

    def bulky(self, since: float, limits: tuple[Limit, ...]) -> list[Send]:
        """Return what was sent since then on which somebody decided, and for which windows may be stretched."""
        self._follow(limits)
        return self._bulky.since(since)

    def sends(
        self, now: float, since: float, limits: tuple[Limit, ...], leave_after: float, *, words: bool
    ) -> tuple[Send, ...]:
        """Return what was sent since then, and leaves as late as ours: all of it, or all but the `words`."""
        sent = [each for each in self._traffic.sent_since(since) if words or each[2] != WORDS]
        alike = {amount: use_of(*amount, limits, own=False) for amount in {amount for _, amount, *_ in sent}}
        uses = [self._counting(t, alike[amount]) for t, amount, *_ in sent]
        # Digests come late, and in any order.
        undecided = sorted((k for k, (*_, decided) in enumerate(sent) if not decided), key=lambda k: sent[k][0])
        if undecided:
            times = [sent[place][0] for place in undecided]
            rooms = [self._room(now - c.window, k, c.limit) for k, c in enumerate(limits)]
            counts = zip(
                *(
                    _within(rooms[k], c.window, times, [uses[place][k] for place in undecided])
                    for k, c in enumerate(limits)
                ),
                strict=True,
            )
            for place, use in zip(undecided, counts, strict=True):
                uses[place] = use
        return tuple([(min(t + leave_after, max(t, now)), use) for (t, *_), use in zip(sent, uses, strict=True)])

    def _room(self, since: float, k: int, limit: float) -> float:
        """Return how much of a limit may count as used since then by what others send that nobody decides on."""
        return max(0.0, (1.0 - self._view.specs.floor) * limit - self._ours.used(since, k))

    def _follow(self, limits: tuple[Limit, ...]) -> None:
        """Take in what was noted since the last time; all of it under other limits, or when something was retracted."""
        traffic = self._traffic
        noted = traffic.noted, traffic.retracted
        if noted == self._taken and limits is self._limits:
            return
        sends, retracted = self._taken
        if limits != self._limits or retracted != traffic.retracted:
            self._decided, self._undecided, self._bulky, sends = SendLog(), SendLog(), SendLog(), 0
        self._limits, self._taken = limits, noted
        new = list(islice(traffic.sends, max(0, len(traffic.sends) - noted[0] + sends), None))
        uses = [(t, self._counting(t, use_of(*amount, limits, own=False))) for t, amount, *_ in new]
        decided = [send for send, (*_, by_limits) in zip(uses, new, strict=True) if by_limits]
        self._decided.add_all(decided)
        self._undecided.add_all([send for send, (*_, by_limits) in zip(uses, new, strict=True) if not by_limits])
        self._bulky.add_all([send for send in decided if is_bulky(send[1], limits)])

    def _counting(self, t: float, use: tuple[float, ...]) -> tuple[float, ...]:
        """Return what of the use of a message that was sent at `t` [s] counts against the limits in force."""
        place = bisect_right(self._earlier, t, key=itemgetter(0))
        return _part(use, self._earlier[place][1]) if place < len(self._earlier) else use


def _part(use: Sequence[float], parts: Sequence[float]) -> tuple[float, ...]:
    return tuple([amount * part for amount, part in zip(use, parts, strict=True)])


def _within(room: float, window: float, times: Sequence[float], amounts: Sequence[float]) -> list[float]:
    """Return what counts of amounts that were sent at these times so that no window holds more: the newest do first."""
    counts, newer, held = list[float](), deque[tuple[float, float]](), 0.0
    for t, amount in zip(reversed(times), reversed(amounts), strict=True):
        while newer and newer[0][0] > t + window:
            held -= newer.popleft()[1]
        counts.append(min(amount, max(0.0, room - held)))
        newer.append((t, counts[-1]))
        held += counts[-1]
    return counts[::-1]
