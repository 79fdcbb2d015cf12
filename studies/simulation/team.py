"""A team of cores on one medium: a discrete-event simulation in which every robot runs the daemon's core."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from planner import Plan, SearchSettings, start
from proxy.core.core import Core
from proxy.core.gossip.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.interface.commands import AskState, Command, Decide, Drop, Forward, SendDigest, SendState
from proxy.core.model.settings import CoreSettings, is_broadcast
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, State
from proxy.core.protocol.state_codec import pack_state
from proxy.core.view.subscribers import intersects
from studies.simulation.agenda import Agenda
from studies.simulation.churn import Happening, joining
from studies.simulation.clocks import Clock
from studies.simulation.medium import Medium
from studies.simulation.member import Member
from studies.simulation.membership import Membership
from studies.simulation.network import Network, OverMedium
from studies.simulation.records import Delivery, Frame, OnAir
from utility_specs import Specs

__all__ = ["Delivery", "Frame", "Team"]

DIGEST_OVERHEAD = 15
"""Bytes around a digest on the wire."""
DECISION_TIME = 0.003
"""What is decided goes so much later, whoever decides [s]."""


@dataclass
class Team:
    """Robots by name, each with its subscriptions; `clocks` by robot, or how far each is off [s].

    `happenings` are told in the order of their times. What was sent is in `deliveries`, by receiver, and in `on_air`.
    """

    specs: Specs
    interests: Mapping[str, tuple[str, ...]]
    medium: Medium
    seed: int = 0
    iterations: int = 300
    decision_time: float = DECISION_TIME
    clocks: Mapping[str, Clock | float] = field(default_factory=dict)
    settings: CoreSettings = field(default_factory=lambda: CoreSettings("", ""))
    search: SearchSettings = field(default_factory=SearchSettings)
    happenings: Sequence[Happening] = ()
    begins: float = 0.0
    """When the robots start that are there from the beginning [s]: applications may begin later."""
    network: Network | None = None
    """What carries messages instead of `medium`, on the agenda of this team."""
    agenda: Agenda = field(default_factory=Agenda)
    deliveries: list[Delivery] = field(default_factory=list)
    on_air: list[OnAir] = field(default_factory=list)
    digest_bytes: int = 0

    def __post_init__(self) -> None:
        self.medium.seed = self.seed
        self._carrier = self.network or OverMedium(self.medium, self.agenda)
        self._broadcast = is_broadcast(self.settings.transport)
        self._matching: dict[tuple[tuple[str, ...], str], bool] = {}
        self._starts: dict[str, int] = {}
        absent = joining(self.happenings)
        self.members = {robot: self._member(robot, self.begins) for robot in self.interests if robot not in absent}
        meeting = self.agenda, self._carrier, self.members, self._feed, self._member
        self.membership = Membership(*meeting, count=self._count)

    @property
    def cores(self) -> dict[str, Core]:
        """The cores of the robots that run, by name."""
        return {robot: member.core for robot, member in self.members.items()}

    def run(self, frames: Sequence[Frame], until: float) -> list[Delivery]:
        """Let the apps publish `frames` and return everything that was sent by `until` [s]."""
        self.membership.start(self.begins, self.happenings)
        for number, frame in enumerate(frames):
            self.agenda.at(frame.t_gen, partial(self._publish, number, frame))
        self.agenda.run(until)
        return self.deliveries

    def _member(self, robot: str, t: float) -> Member:
        """Start a robot, with a new id when it ran before."""
        number = self._starts[robot] = self._starts.get(robot, 0) + 1
        zid = f"z-{robot}" if number == 1 else f"z{number}-{robot}"
        given = self.clocks.get(robot, 0.0)
        clock = given if isinstance(given, Clock) else Clock(given)
        now = clock.monotonic(t)
        settings = replace(
            self.settings, robot=robot, zid=zid, iterations=self.iterations, wall_offset=clock.wall_time(t) - now
        )
        return Member(robot, zid, self.interests[robot], clock, Core(settings, self.specs, now))

    def _publish(self, number: int, frame: Frame, t: float) -> None:
        member = self.members.get(frame.robot)
        if member is not None:
            member.frames[number] = frame
            now = member.now(t)
            self._match(member, t, frame.key)
            self._feed(member, t, ev.SamplePublished(now, number, frame.key, frame.size, now, None, 5, frame.features))

    def _match(self, member: Member, t: float, key: str) -> None:
        """Zenoh tells a robot at once whether anybody subscribes to a key of its, before a state says who.

        An operator of twelve robots that looks at another one each 10 s has no room to tell all of them that so often:
        what it looked at went unbooked without this.
        """
        matching = any(self._wants(other, key) for other in self.membership.linked(member))
        if member.matching.get(key) is not matching:
            member.matching[key] = matching
            self._feed(member, t, ev.MatchingChanged(member.now(t), key, matching))

    def _feed(self, member: Member, t: float, event: ev.Event) -> None:
        if not member.running:
            return
        for command in member.core.handle(event):
            self._execute(member, t, command)
        stepped = member.wall_step(t)
        if stepped is not None:
            self._feed(member, t, ev.ClockChanged(member.now(t), stepped.offset, stepped.error))
            return
        wake = member.clock.true(member.core.wake_at(member.now(t)))
        if member.wake <= t or wake < member.wake:
            member.wake = max(wake, t + 1e-4)
            self.agenda.at(member.wake, partial(self._wake, member))

    def _wake(self, member: Member, t: float) -> None:
        if t >= member.wake:
            self._feed(member, t, ev.TimePassed(member.now(t)))

    def _execute(self, member: Member, t: float, command: Command) -> None:
        match command:
            case Decide():
                search = start(command.problem, self.search, command.seed)
                search.run(command.iterations)
                decided = partial(self._decided, member, command.ticket, search.plan())
                self.agenda.at(t + self.decision_time, decided)
            case Forward(sample):
                self._transmit(member, t, member.frames.pop(sample))
                self.agenda.at(t, partial(self._handed, member, sample))
            case Drop(sample):
                del member.frames[sample]
            case SendDigest(digest):
                self._tell(member, t, digest)
            case SendState(state, update):
                self._publish_state(member, t, state, update)
            case AskState(robot):
                self.membership.ask(member, robot, t)

    def _decided(self, member: Member, ticket: int, plan: Plan, t: float) -> None:
        self._feed(member, t, ev.DecisionReady(member.now(t), ticket, plan))

    def _handed(self, member: Member, sample: int, t: float) -> None:
        self._feed(member, t, ev.SampleHanded(member.now(t), sample))

    def _tell(self, member: Member, t: float, digest: Digest) -> None:
        """Send a digest to all who are linked, one copy each or one for all on the air."""
        size = len(pack_digest(digest)) + DIGEST_OVERHEAD
        others = {other.robot: other for other in self.membership.linked(member)}
        on_air, copies = self.settings.digests_on_air, len(others)
        if on_air:
            size += TUNING.on_air + len(member.robot)
            copies = 1
        self.digest_bytes += size * copies
        self.on_air.append(OnAir(t, member.robot, size * copies, digest=True))

        def arrive(robot: str, at: float) -> None:
            self._hear_digest(others[robot], digest, size - DIGEST_OVERHEAD, at)

        self._carrier.send(t, size, member.robot, others, arrive, broadcast=on_air)

    def _publish_state(self, member: Member, t: float, state: State, update: State | None) -> None:
        """Answer queries with a state from now on, and send it, or an update, reliably to all who are linked."""
        member.state = state
        others = self.membership.linked(member)
        told = state if update is None else update
        size = len(pack_state(told))
        self.on_air.append(OnAir(t, member.robot, size * len(others)))
        for other in others:
            self._carrier.reliable(t, size, member.robot, other.robot, partial(self._hear_state, other, told, size))

    def _count(self, t: float, robot: str, size: int) -> None:
        """A robot says so many bytes to another one that are neither a sample nor a digest."""
        self.on_air.append(OnAir(t, robot, size))

    def _hear_digest(self, member: Member, digest: Digest, size: int, t: float) -> None:
        self._feed(member, t, ev.DigestHeard(member.now(t), digest, size))

    def _hear_state(self, member: Member, state: State, size: int, t: float) -> None:
        self._feed(member, t, ev.StateHeard(member.now(t), state, size))

    def _transmit(self, member: Member, t: float, frame: Frame) -> None:
        linked = {other.robot: other for other in self.membership.linked(member)}
        wanting = [robot for robot, other in linked.items() if self._wants(other, frame.key)]
        if not any(self.membership.met(member, linked[robot]) for robot in wanting):
            return
        copies = 1 if self._broadcast else len(wanting)
        self.on_air.append(OnAir(t, member.robot, frame.size * copies, frame))
        places = {robot: len(self.deliveries) + k for k, robot in enumerate(wanting)}
        self.deliveries += [Delivery(frame, t, None, robot) for robot in wanting]
        stamp = member.clock.wall_time(frame.t_gen)

        def arrive(robot: str, at: float) -> None:
            if robot in places:
                self.deliveries[places.pop(robot)] = Delivery(frame, t, at, robot)
            self._hear(linked[robot], frame, member.zid, stamp, at)

        receivers = linked if self._broadcast else wanting
        self._carrier.send(t, frame.size, member.robot, receivers, arrive, broadcast=self._broadcast)

    def _wants(self, member: Member, key: str) -> bool:
        place = member.keys, key
        if place not in self._matching:
            self._matching[place] = any(intersects(expression, key) for expression in member.keys)
        return self._matching[place]

    def _hear(self, member: Member, frame: Frame, origin: str, stamp: float, t: float) -> None:
        self._feed(member, t, ev.SampleHeard(member.now(t), frame.key, frame.size, origin, stamp, None))
