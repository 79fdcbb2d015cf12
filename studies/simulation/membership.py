"""Who is on the mesh, who hears whom, and when the others learn of it."""

from collections.abc import Callable, Sequence
from functools import partial

from proxy.core.gossip.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.protocol.messages import State
from proxy.core.protocol.state_codec import pack_state
from studies.simulation.agenda import Agenda
from studies.simulation.churn import Crash, Happening, Join, Leave, Merge, Partition, Subscribe
from studies.simulation.member import Member
from studies.simulation.network import Network

LIVELINESS = 0.008
"""Until a robot is noticed that comes, or that says that it goes [s], besides the way through the air."""
LEASE = 2.0
"""Until a robot is missed that fell silent [s]."""


class Membership:
    """Runs the happenings: tells the members of each other as liveliness tokens would, and answers state queries."""

    def __init__(
        self,
        agenda: Agenda,
        network: Network,
        members: dict[str, Member],
        feed: Callable[[Member, float, ev.Event], None],
        make: Callable[[str, float], Member],
        *,
        count: Callable[[float, str, int], None],
    ) -> None:
        """`count` takes the time [s], the robot and the bytes of what it says to another one."""
        self._agenda = agenda
        self._network = network
        self._members = members
        self._feed = feed
        self._make = make
        self._count = count
        self._groups: tuple[frozenset[str], ...] | None = None
        self._known: dict[tuple[Member, Member], None] = {}
        self._met: set[tuple[Member, Member]] = set()

    def start(self, begins: float, happenings: Sequence[Happening]) -> None:
        """Let the members there are know of each other from `begins` on [s], and everything happen in its time."""
        for member in self._members.values():
            self._agenda.at(begins, partial(self._subscribe, member))
        self._agenda.at(begins, self._look)
        for happening in happenings:
            self._agenda.at(happening.t, partial(self._happen, happening))

    def linked(self, member: Member) -> list[Member]:
        """Return all who can hear the member now."""
        return [o for o in self._members.values() if o is not member and self._together(member, o)]

    def met(self, one: Member, other: Member) -> bool:
        """Whether a member noticed another one: before, its daemon takes no samples from the apps for it."""
        return (one, other) in self._met

    def _together(self, one: Member, other: Member) -> bool:
        if not (one.running and other.running):
            return False
        return self._groups is None or any(one.robot in group and other.robot in group for group in self._groups)

    def _happen(self, happening: Happening, t: float) -> None:
        match happening:
            case Join(_, robot):
                member = self._members[robot] = self._make(robot, t)
                self._subscribe(member, t)
                self._look(t)
            case Leave(_, robot):
                self._end(self._members.pop(robot), t, LIVELINESS)
            case Crash(_, robot):
                self._end(self._members.pop(robot), t, LEASE)
            case Partition(_, groups):
                self._groups = groups
                self._part(t, LEASE)
                self._look(t)
            case Merge():
                self._groups = None
                self._look(t)
            case Subscribe(_, robot, keys):
                if (subscriber := self._members.get(robot)) is not None:
                    subscriber.keys = keys
                    self._subscribe(subscriber, t)

    def _subscribe(self, member: Member, t: float) -> None:
        self._feed(member, t, ev.InterestChanged(member.now(t), member.keys))

    def _end(self, member: Member, t: float, noticed: float) -> None:
        member.running = False
        self._part(t, noticed)

    def _part(self, t: float, noticed: float) -> None:
        """Let those who heard each other until now miss each other once it is noticed."""
        for one, other in self._known:
            if not self._together(one, other):
                self._agenda.at(t + noticed, partial(self._miss, one, other))

    def _look(self, t: float) -> None:
        """Tell everybody of those who are there now and were not."""
        for one in list(self._members.values()):
            for other in self.linked(one):
                if (one, other) not in self._known:
                    self._known[one, other] = None
                    noticed = t + self._network.delay(other.robot, one.robot) + LIVELINESS
                    self._agenda.at(noticed, partial(self._meet, one, other))

    def _meet(self, one: Member, other: Member, t: float) -> None:
        """`one` notices `other`."""
        if (one, other) not in self._known:
            return
        self._met.add((one, other))
        self._feed(one, t, ev.PeerAppeared(one.now(t), other.robot, other.zid))

    def ask(self, one: Member, robot: str, t: float) -> None:
        """`one` asks a robot for its state, which arrives later if the robot is there."""
        other = self._members.get(robot)
        if other is not None:
            self._count(t, one.robot, TUNING.question)
            self._network.reliable(t, TUNING.question, one.robot, robot, partial(self._asked, one, other))

    def _asked(self, one: Member, other: Member, t: float) -> None:
        if self._together(one, other) and other.state is not None:
            size = len(pack_state(other.state))
            self._count(t, other.robot, size)
            self._network.reliable(t, size, other.robot, one.robot, partial(self._answer, one, other.state))
            self._feed(other, t, ev.StateAsked(other.now(t)))

    def _answer(self, one: Member, state: State, t: float) -> None:
        self._feed(one, t, ev.StateHeard(one.now(t), state, len(pack_state(state))))

    def _miss(self, one: Member, other: Member, t: float) -> None:
        if not self._together(one, other) and (one, other) in self._known:
            del self._known[one, other]
            self._met.discard((one, other))
            self._feed(one, t, ev.PeerGone(one.now(t), other.robot, other.zid))
