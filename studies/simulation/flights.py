"""A mission flown by a team of the daemon's cores."""

from typing import TypeVar

from planner import SearchSettings
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from studies.simulation.clocks import synchronised
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.medium import Medium
from studies.simulation.missions import Mission
from studies.simulation.team import Team

T = TypeVar("T", bound=Team)
GROUP = "224.0.0.226:7449"
"""On which all broadcast."""


def team(flown: Mission, how: Conditions, seed: int) -> Team:
    """Return a team that is ready to fly the mission."""
    return crew(Team, flown, how, seed)


def crew(kind: type[T], flown: Mission, how: Conditions, seed: int) -> T:
    """Return a team of this kind that is ready to fly the mission."""
    return kind(
        flown.specs,
        flown.interests,
        Medium(
            how.rate,
            how.latency,
            how.loss,
            how.jitter,
            how.duplication,
            how.reordering,
            ways=dict(how.ways),
            rates=how.rates,
        ),
        seed=seed,
        iterations=how.iterations,
        clocks=how.clocks or synchronised(flown.interests, how.clock_error, seed),
        settings=CoreSettings(
            "",
            "",
            coordination=how.coordination,
            transport=UNICAST if how.unicast else broadcast(GROUP),
            allowance=how.allowance,
            digests_on_air=how.digests_on_air and not how.unicast,
        ),
        search=SearchSettings(search="best"),
        happenings=how.happenings,
    )


def fly(flown: Mission, how: Conditions, seed: int) -> Team:
    """Let a team fly the mission, and return it with what it sent."""
    ready = team(flown, how, seed)
    ready.run(flown.frames, WARM_UP + how.seconds)
    return ready
