"""While there is room for all, nothing is planned, nothing waits and nothing is dropped."""

import math

import numpy as np
import pytest

from planner import SearchSettings
from proxy.core.settings import CoreSettings
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from utility_specs import load_specs

LIMIT, WINDOW = 125_000.0, 0.5
SPEC = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
window = 0.5
[[information_type]]
name = "any"
keys = ["robot/**"]
utility = { kind = "linear", slope = 1.0 }
"""


def frames(robot, begin, end, rate, size):
    """What a robot generates."""
    times = np.arange(begin, end, 1.0 / rate)
    return [Frame(robot, f"robot/{robot}/{size}", float(t), size, {}) for t in times]


@pytest.fixture
def specs(tmp_path):
    path = tmp_path / "specs.toml"
    path.write_text(SPEC)
    return load_specs(path)


def worst_window(deliveries):
    sent = sorted((d.t_sent, d.frame.size) for d in deliveries)
    return max(sum(size for t, size in sent if end - WINDOW <= t <= end) for end, _ in sent)


@pytest.mark.parametrize(("coordination", "most"), [("shares", 1.0), ("overhear", 1.3)])
def test_everything_is_sent_while_there_is_room_for_all(specs, coordination, most):
    """Also streams too quick to lend for each of their messages; then a flood comes, and the limit holds.

    Who plans for all without overhearing anybody exceeds it somewhat, then as ever.
    """
    team = Team(
        specs,
        {"r1": (), "r2": (), "r3": (), "op": ("robot/**",)},
        Medium(250_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", "", coordination=coordination),
    )
    small = [frame for k in (1, 2, 3) for frame in frames(f"r{k}", 1.0 + 0.003 * k, 12.0, 50.0, 200)]
    flood = [frame for k in (1, 2) for frame in frames(f"r{k}", 8.0 + 0.01 * k, 12.0, 10.0, 15_000)]
    deliveries = team.run(sorted([*small, *flood], key=lambda frame: frame.t_gen), 13.0)
    calm = [d for d in deliveries if d.receiver == "op" and 6.0 <= d.frame.t_gen < 8.0]
    assert len(calm) == sum(6.0 <= frame.t_gen < 8.0 for frame in small)
    assert worst_window([d for d in deliveries if d.receiver == "op"]) <= most * LIMIT * WINDOW
    assert all(core.gate.decisions.unneeded > 0 for name, core in team.cores.items() if name != "op")
    assert sum(core.gate.decisions.made for core in team.cores.values()) > 0


def test_streams_that_begin_in_an_idle_team_find_room(specs):
    """Before anybody knows what they need: on an empty channel nearly nothing is dropped."""
    team = Team(
        specs,
        {"r1": (), "r2": (), "r3": (), "op": ("robot/**",)},
        Medium(250_000.0),
        search=SearchSettings(search="best"),
        settings=CoreSettings("", "", coordination="shares"),
    )
    begun = [frame for k in (1, 2, 3) for n in range(4) for frame in frames(f"r{k}", 5.0 + 0.01 * n, 8.0, 2.0, 200 + n)]
    deliveries = team.run(sorted(begun, key=lambda frame: frame.t_gen), 9.0)
    assert sum(d.receiver == "op" for d in deliveries) >= 0.97 * len(begun)


def test_where_nothing_is_shared_nothing_is_lent(tmp_path):
    """Energy is each robot's own: there is nothing to tell grants of."""
    path = tmp_path / "energy.toml"
    energy = 'kind = "energy"\nlimit = "1 J"\nper_message = "1 mJ"'
    path.write_text(SPEC.replace('kind = "throughput"\nlimit = "1 Mbit/s"', energy))
    interests = {"r1": (), "r2": (), "op": ("robot/**",)}
    settings = CoreSettings("", "", coordination="shares")
    team = Team(load_specs(path), interests, Medium(250_000.0), settings=settings)
    deliveries = team.run(frames("r1", 1.0, 6.0, 10.0, 200), 8.0)
    assert any(d.receiver == "op" for d in deliveries)
    assert {core.layout.lent for core in team.cores.values()} == {0}
    assert {core.layout.due_at for core in team.cores.values()} == {math.inf}
