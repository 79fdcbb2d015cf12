"""Adaptive limits on a simulated channel that nobody told the robots about."""

from collections import Counter
from itertools import pairwise

import pytest

from planner import SearchSettings
from studies.simulation.medium import Medium
from studies.simulation.team import Frame, Team
from utility_specs import load_specs

SPEC = """
[[constraint]]
kind = "throughput"
{limit}

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = {{ kind = "video" }}
"""
ADAPTIVE = 'limit = "adaptive"\nceiling = "6 Mbit/s"\nfloor = "200 kbit/s"'
RATE = 250_000.0
SIZE = 10_000


@pytest.fixture
def fly(tmp_path):
    """Let robots send more than the channel carries to an operator; return the team and what arrived."""
    path = tmp_path / "spec.toml"

    def run(robots, seconds, limit=ADAPTIVE, size=SIZE, total=40.0, **medium):
        path.write_text(SPEC.format(limit=limit))
        specs = load_specs(path)
        interests = {f"r{i}": () for i in range(robots)} | {"op": ("robot/*/camera",)}
        rate = total / robots
        frames = [
            Frame(f"r{i}", f"robot/r{i}/camera", 1.0 + 0.023 * i + k / rate, size, {})
            for k in range(int(seconds * rate))
            for i in range(robots)
        ]
        team = Team(specs, interests, Medium(RATE, **medium), search=SearchSettings(search="best"), iterations=10)
        sent = team.run(sorted(frames, key=lambda frame: frame.t_gen), seconds)
        return team, [delivery for delivery in sent if delivery.t_rcv]

    return run


@pytest.mark.full
def test_a_channel_is_used_shared_fairly_and_noticed_when_it_is_halved(fly):
    """Random loss does not matter. After the change samples arrive as soon as before within seconds."""
    team, arrived = fly(2, 24.0, loss=0.05, rates=((16.0, RATE / 2.0),))
    late = [d for d in arrived if 10.0 <= d.t_rcv < 16.0]
    assert len(late) * SIZE / 6.0 >= 0.7 * 0.95 * RATE
    counts = Counter(d.frame.robot for d in late)
    assert min(counts.values()) >= 0.8 * max(counts.values())
    ages = sorted(d.t_rcv - d.t_sent for d in late)
    assert ages[len(ages) // 2] <= 0.15
    ages = sorted(d.t_rcv - d.t_sent for d in arrived if d.t_sent >= 20.0)
    assert ages[len(ages) // 2] <= 0.3
    assert max(core.channel.capacity.factors[0] for core in team.cores.values()) <= 0.45


def test_samples_may_take_longer_than_what_is_lent_ahead_of_time(fly):
    """What tells of it is small and soon there: a known limit is used, however long a sample is on its way."""
    _, arrived = fly(3, 8.0, limit=f'limit = "{0.9 * RATE} B/s"\nwindow = 1', size=40_000, total=15.0, delay=0.02)
    assert sum(d.frame.size for d in arrived if 4.0 <= d.t_rcv < 8.0) >= 0.35 * 4.0 * RATE


@pytest.mark.full
@pytest.mark.parametrize("delay", [0.03, *(pytest.param(delay, marks=pytest.mark.full) for delay in (0.01, 0.02))])
def test_who_leads_goes_on_hearing_of_the_channel(fly, delay):
    """Also while robots save up for a digest to all: silence would be taken for a queue."""
    limit = 'limit = "adaptive"\nceiling = "240 kbit/s"\nwindow = 1'
    team, _ = fly(3, 18.0, limit=limit, size=3_000, total=12.0, delay=delay)
    told = [sent.t for sent in team.on_air if sent.digest and sent.robot != "op" and sent.t >= 8.0]
    assert max(after - before for before, after in pairwise([8.0, *told, 18.0])) <= 4.0
