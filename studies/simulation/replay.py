"""What a robot would have decided if clocks had been others: all that it lived through, told anew by those clocks.

Flights under different clocks part for good once a single decision falls differently. So here each decision is
compared by itself: the robot goes on with what was decided in the flight.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

from planner import start
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Decide, Drop, Forward, SendDigest
from proxy.core.protocol.messages import Digest, tag
from proxy.core.protocol.state_codec import pack_state
from proxy.tuning import TUNING
from studies.simulation.clocks import BOOT, EPOCH, Clock
from studies.simulation.medium import RELIABLE, Medium
from studies.simulation.member import Member
from studies.simulation.team import Team

T = TypeVar("T")


@dataclass(slots=True)
class Life:
    """What happened to one robot from outside, at true times [s], and what it decided."""

    events: list[tuple[float, ev.Event]] = field(default_factory=list)
    sends: dict[int, bool] = field(default_factory=dict)
    """What became of each sample; of those that were searched for, what the last search said."""
    told: list[float] = field(default_factory=list)
    """When it sent digests, which others echo."""
    tickets: dict[int, list[int]] = field(default_factory=dict)
    """Of those that were searched for, the ticket of each search: who gives way is searched for again."""
    answers: dict[int, list[bool]] = field(default_factory=dict)
    """What each of these searches said."""

    @property
    def weighed(self) -> set[int]:
        """The samples that a search decided, and those that were sent."""
        return self.tickets.keys() | {sample for sample, sent in self.sends.items() if sent}

    def note(self, command: Command) -> None:
        """Take in what became of a sample."""
        if isinstance(command, Forward | Drop):
            self.sends.setdefault(command.sample, isinstance(command, Forward))

    def answered(self, sample: int, *, send: bool) -> None:
        """Take in what a search said."""
        self.answers.setdefault(sample, []).append(send)
        self.sends[sample] = send


class Recorded(Team):
    """A team, of which every robot's life is kept; its clocks have to be right."""

    def __post_init__(self) -> None:
        self.lives = {robot: Life() for robot in self.interests}
        super().__post_init__()

    def _feed(self, member: Member, t: float, event: ev.Event) -> None:
        life, pending = self.lives[member.robot], member.core.gate.search.pending
        if not isinstance(event, ev.DecisionReady | ev.SampleHanded | ev.TimePassed):
            life.events.append((t, event))
        elif isinstance(event, ev.DecisionReady) and event.plan and pending and pending.ticket == event.ticket:
            life.answered(pending.sample.sample, send=event.plan.send)
        super()._feed(member, t, event)

    def _execute(self, member: Member, t: float, command: Command) -> None:
        life, pending = self.lives[member.robot], member.core.gate.search.pending
        life.note(command)
        if isinstance(command, SendDigest):
            life.told.append(t)
        if isinstance(command, Decide) and pending is not None and pending.ticket == command.ticket:
            life.tickets.setdefault(pending.sample.sample, []).append(command.ticket)
        super()._execute(member, t, command)


def decided_alike(flight: Recorded, clocks: Mapping[str, Clock], until: float) -> list[bool]:
    """Return for every sample that was weighed in a flight whether it fares alike by these clocks."""
    return [alike for robot in flight.interests for alike in Relived(flight, robot, clocks).alike(until)]


class Relived(Team):
    """One robot of a flight, alone with what it lived through, as it was or would have been by these clocks."""

    def __init__(self, flight: Recorded, robot: str, clocks: Mapping[str, Clock]) -> None:
        given = {each: clocks.get(each, Clock()) for each in flight.interests}
        super().__init__(
            flight.specs,
            {robot: flight.interests[robot]},
            Medium(flight.medium.rate),
            iterations=flight.iterations,
            decision_time=flight.decision_time,
            clocks={robot: given[robot]},
            settings=flight.settings,
            search=flight.search,
        )
        self._robot = robot
        self._before = flight.lives[robot]
        self._now = Life()
        self._retelling = _Retelling(given, robot)

    def alike(self, until: float) -> Iterator[bool]:
        """Live until then [s]; yield for every sample that was weighed, then or now, whether it fares alike."""
        (member,) = self.members.values()
        for t, event in self._retelling.of(self._before.events):
            self.agenda.at(t, partial(self._happen, member, event))
        for t in self._before.told:
            self.agenda.at(t, partial(self._mark, member))
        self.agenda.run(until)
        before, now = self._before, self._now
        for sample in sorted(before.weighed | now.weighed):
            yield before.sends.get(sample) == now.sends.get(sample)

    def _mark(self, member: Member, t: float) -> None:
        """Others have heard a digest of ours that went out now."""
        member.core.view.sent_digest(member.now(t))

    def _happen(self, member: Member, event: ev.Event, t: float) -> None:
        self._feed(member, t, event)

    def _execute(self, member: Member, t: float, command: Command) -> None:
        self._now.note(command)
        match command:
            case Decide():
                self._decide(member, t, command)
            case Forward(sample):
                self.agenda.at(t, partial(self._handed, member, sample))

    def _decide(self, member: Member, t: float, command: Decide) -> None:
        """Search as then, and go on with what was decided then."""
        pending, before, now = member.core.gate.search.pending, self._before, self._now
        sample = pending.sample.sample if pending is not None and pending.ticket == command.ticket else -1
        again = len(now.tickets.get(sample, ()))
        search = start(command.problem, self.search, _at(again, before.tickets.get(sample, ()), command.seed))
        search.run(command.iterations)
        plan = search.plan()
        if sample >= 0:
            now.tickets.setdefault(sample, []).append(command.ticket)
            now.answered(sample, send=plan.send)
            plan = replace(plan, send=_at(again, before.answers.get(sample, ()), plan.send))
        self.agenda.at(t + self.decision_time, partial(self._decided, member, command.ticket, plan))


def _at(place: int, found: Sequence[T], otherwise: T) -> T:
    return found[place] if place < len(found) else otherwise


@dataclass(frozen=True, slots=True)
class _Retelling:
    """Tells what happened to `robot` by the clocks of all robots, those of before being right."""

    clocks: Mapping[str, Clock]
    robot: str

    def of(self, events: list[tuple[float, ev.Event]]) -> Iterator[tuple[float, ev.Event]]:
        """Yield what happens; a wall clock that was set is told of as late as can be."""
        yield from ((t, self._told(t, event)) for t, event in events)
        for robot, clock in self.clocks.items():
            for at, _ in clock.steps if robot != self.robot else ():
                late = at + TUNING.wall_clock_interval + RELIABLE
                heard = [e.state for t, e in events if t < late and isinstance(e, ev.StateHeard)]
                known = next((state for state in reversed(heard) if state.robot == robot), None)
                if known is not None:
                    news = replace(known, streams=(), since=known.number)
                    yield late, self._told(late, ev.StateHeard(BOOT + late, news, len(pack_state(news))))

    def _told(self, t: float, event: ev.Event) -> ev.Event:
        now = self._time(self.robot, event.now)
        match event:
            case ev.SamplePublished():
                return replace(event, now=now, t_gen=self._time(self.robot, event.t_gen))
            case ev.SampleHeard(stamp=float(stamp), origin=str(origin)):
                sender = self.clocks[origin.split("-", 1)[1]]
                return replace(event, now=now, stamp=sender.wall_time(stamp - EPOCH))
            case ev.DigestHeard():
                return replace(event, now=now, digest=self._digest(event.digest))
            case ev.StateHeard():
                clock = self.clocks[event.state.robot]
                told = clock.wall_time(t - RELIABLE) - clock.monotonic(t - RELIABLE)
                return replace(event, now=now, state=replace(event.state, wall_offset=told))
        return replace(event, now=now)

    def _time(self, robot: str, shown: float) -> float:
        """What a robot's clock shows when it showed this before [s]."""
        return self.clocks[robot].monotonic(shown - BOOT)

    def _digest(self, digest: Digest) -> Digest:
        shown = partial(self._time, digest.robot)
        return replace(
            digest,
            sent=shown(digest.sent),
            streams=tuple(
                replace(
                    news,
                    t_generated=shown(news.t_generated),
                    t_forwarded=shown(news.t_forwarded) if news.forwarded else 0.0,
                )
                for news in digest.streams
            ),
            echoes=tuple(
                replace(echo, sent=self._time(self._named(echo.peer), echo.sent), received=shown(echo.received))
                for echo in digest.echoes
            ),
        )

    def _named(self, peer: str) -> str:
        """The robot with this tag."""
        return next(robot for robot in self.clocks if tag(f"z-{robot}") == peer)
