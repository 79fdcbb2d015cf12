"""Missions of real traffic flown: by a team of the daemon's cores, or by one core that decides for all."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from planner import SearchSettings
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from studies.simulation.churn import Happening
from studies.simulation.flights import GROUP
from studies.simulation.medium import Medium, Way
from studies.simulation.team import Team
from studies.simulation.traffic.missions import ALONE, RATE, Mission, alone

CENTRAL = "announce"
"""The coordination of one robot alone: it plans for all there is, and waits for nobody."""
SOON = 0.001
"""How late one that decides for all hears of receivers [s], whatever its samples take."""


@dataclass(frozen=True, slots=True)
class How:
    """How a team flies: `settings` are further ones of the core, by name; latency is seconds, loss a probability.

    The medium's `rate` is in B/s.
    """

    coordination: str = "announce"
    transport: str = "unicast"
    latency: float = 0.02
    loss: float = 0.01
    iterations: int = 300
    settings: tuple[tuple[str, Any], ...] = ()
    rate: float = RATE
    before: float = 0.0
    """So long before the applications begin the daemons run [s]."""

    @property
    def broadcasts(self) -> bool:
        """Whether every robot hears, and wants, everything."""
        return self.transport != UNICAST


def fly(mission: Mission, how: How, seed: int, happenings: Sequence[Happening] = ()) -> Team:
    """Let a team fly the mission while this happens; return it with what it sent."""
    ready = crew(mission, how, seed, happenings)
    ready.run(mission.frames, mission.problem.t_end)
    return ready


def crew(mission: Mission, how: How, seed: int, happenings: Sequence[Happening] = ()) -> Team:
    """Return a team that is ready to fly the mission, and to which this happens."""
    further: dict[str, Any] = {"coordination": how.coordination, **dict(how.settings)}
    settings = CoreSettings(
        "", "", transport=broadcast(GROUP) if how.broadcasts else UNICAST, digests_on_air=how.broadcasts
    )
    return Team(
        mission.specs,
        mission.interests,
        Medium(how.rate, how.latency, how.loss),
        seed=seed,
        iterations=how.iterations,
        settings=replace(settings, **further),
        search=SearchSettings(search="best"),
        happenings=happenings,
        begins=-how.before,
    )


def fly_alone(mission: Mission, how: How, seed: int, happenings: Sequence[Happening] = ()) -> tuple[Mission, Team]:
    """Let one core decide for all streams, as fast as it is asked; return the mission as it flew and the team."""
    by_one = alone(mission)
    by_itself = replace(how, coordination=CENTRAL, transport=UNICAST, settings=(("allowance", 0.0),))
    ready = crew(by_one, by_itself, seed, happenings)
    ready.decision_time = 0.0
    ready.medium.ways |= {(name, ALONE): Way(SOON) for name in mission.receivers}
    ready.run(by_one.frames, by_one.problem.t_end)
    # Who decides for all need tell nobody anything.
    ready.on_air = [air for air in ready.on_air if air.frame is not None]
    return by_one, ready
