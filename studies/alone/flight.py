"""A mission flown by robots that decide alone: who sends what, who hears it when, and what decisions cost."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from time import process_time

from planner import Message, Problem
from proxy.core.view.subscribers import intersects
from studies.alone.robot import Robot
from studies.central import Policy
from studies.policies.simple import Draws
from studies.simulation.agenda import Agenda
from studies.simulation.missions import Mission
from studies.simulation.network import Network
from studies.simulation.records import Delivery, Frame, OnAir
from studies.simulation.team import DECISION_TIME

AFTER = 5.0
"""What is sent at the end of a mission is waited for so long [s]."""


@dataclass(slots=True)
class Flight:
    """What happened: to each receiver of each message sent, on the air, and how long each decision took [s].

    A decision's time is that of the processor in the policy, without what it takes to build the window.
    """

    deliveries: list[Delivery] = field(default_factory=list)
    on_air: list[OnAir] = field(default_factory=list)
    decisions: list[float] = field(default_factory=list)


def fly_alone(
    mission: Mission,
    fresh: Callable[[Problem], Policy],
    carry: Callable[[Agenda], Network],
    *,
    seed: int,
    horizon: int = 60,
    broadcast: bool = True,
) -> Flight:
    """Let every robot decide its messages when they are generated, with windows of `horizon` messages.

    `fresh` makes the policy of each robot; one that draws is `dealt` numbers of its own from the `seed`. `carry` makes
    the network on the agenda of the flight, with all members of the mission on it. All of them hear what is broadcast;
    otherwise each gets a copy. What is decided goes `DECISION_TIME` later, as in a team.
    """
    names = sorted(mission.interests)
    robots = {name: Robot(mission.problem, horizon) for name in names}
    policies = {name: _dealt(fresh(mission.problem), f"{seed} {name}") for name in names}
    agenda = Agenda()
    return _Flying(mission, robots, policies, carry(agenda), agenda, broadcast).fly()


@dataclass(slots=True)
class _Flying:
    """A flight under way; robots and policies by name."""

    mission: Mission
    robots: dict[str, Robot]
    policies: dict[str, Policy]
    network: Network
    agenda: Agenda
    broadcast: bool
    flight: Flight = field(default_factory=Flight)

    def fly(self) -> Flight:
        """Let everything happen."""
        for frame, message in zip(self.mission.frames, self.mission.problem.messages, strict=True):
            self.agenda.at(frame.t_gen, partial(self._decide, frame, message))
        self.agenda.run(self.mission.problem.t_end + AFTER)
        return self.flight

    def _decide(self, frame: Frame, message: Message, t: float) -> None:
        robot = self.robots[frame.robot]
        current = robot.generate(message)
        window = robot.window(current)
        begin = process_time()
        send = self.policies[frame.robot](window)
        self.flight.decisions.append(process_time() - begin)
        if send:
            self.agenda.at(t + DECISION_TIME, partial(self._send, frame, current))

    def _send(self, frame: Frame, decided: Message, t: float) -> None:
        message = decided._replace(t_sent=t, t_rcv=decided.t_rcv + DECISION_TIME)
        told, flight = self.robots[frame.robot].send(message), self.flight
        others = [name for name in self.robots if name != frame.robot]
        copies = 1 if self.broadcast else len(others)
        flight.on_air.append(OnAir(t, frame.robot, frame.size * copies, frame))
        wanting = [name for name in others if self._wants(name, frame.key)]
        places = {name: len(flight.deliveries) + k for k, name in enumerate(wanting)}
        flight.deliveries += [Delivery(frame, t, None, name) for name in wanting]

        def arrive(name: str, at: float) -> None:
            if name in places:
                flight.deliveries[places.pop(name)] = Delivery(frame, t, at, name)
            self.robots[name].hear(told, at)

        self.network.send(t, frame.size, frame.robot, others, arrive, broadcast=self.broadcast)

    def _wants(self, name: str, key: str) -> bool:
        return any(intersects(expression, key) for expression in self.mission.interests[name])


def _dealt(policy: Policy, hand: str) -> Policy:
    """Return the policy with numbers of its own, if it draws any: robots do not all draw the same."""
    return policy.dealt(hand) if isinstance(policy, Draws) else policy
