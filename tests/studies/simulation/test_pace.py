"""A team on a channel that is no faster than its limit nearly needs: large samples do not meet there."""

from dataclasses import replace

import numpy as np
import pytest

from studies.simulation.medium import Medium
from studies.simulation.traffic.flights import How, crew
from studies.simulation.traffic.missions import draw

SECONDS = 20.0
KNOWN = 8.0
"""By then robots were told what their frames take [s]."""


@pytest.mark.full
def test_frames_seldom_wait_for_each_other_on_the_channel():
    """Of four cameras that fill nine tenths of a channel most frames find it free: they wait at their robots."""
    mission = draw("cameras-current", 4, 1, SECONDS, latency=0.002)
    team = crew(mission, How(latency=0.002, loss=0.0), 1)
    rate = mission.limit / mission.window / 0.9
    team.medium = replace(team.medium, rate=rate)
    team = replace(team, medium=Medium(rate, 0.002))
    team.run(mission.frames, SECONDS)
    took = [d.t_rcv - d.t_sent - d.frame.size / rate for d in team.deliveries if d.t_rcv and d.t_sent > KNOWN]
    alone = float(np.mean([frame.size for frame in mission.frames])) / rate
    assert np.mean(np.array(took) < 0.25 * alone) > 0.5, np.percentile(np.array(took) / alone, [25, 50, 75, 95])
