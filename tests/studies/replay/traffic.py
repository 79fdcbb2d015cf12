"""Recorded traffic for tests."""

import random

from studies.replay.mission import Mission
from studies.replay.outcomes import Outcomes
from studies.replay.samples import Sample
from studies.simulation.missions import specs_of

SPEC = """
[[constraint]]
kind = "throughput"
limit = "8 kbit/s"
window = 1.0

[[information_type]]
name = "camera"
keys = ["*/camera"]
aggregation = "{aggregation}"
utility = {{ kind = "linear", slope = 0.2 }}
scale = "1 + red"
features.red = {{ kind = "json", path = "red", default = 0.5 }}
"""
"""Room for 1,000 bytes in a second."""
POSE = """
[[information_type]]
name = "pose"
keys = ["*/pose"]
utility = { kind = "exponential", tau = "2 s" }
"""


def spec(aggregation="most_recent"):
    """A camera, of which each sample is worth more the more red it shows."""
    return SPEC.format(aggregation=aggregation)


def mission(text=None, robots=("r1",), latency=0.01):
    """What is to be flown."""
    return Mission(specs_of(spec() if text is None else text), robots, latency)


def samples(seconds=20.0, period=0.5, size=600, *, key="r1/camera", seed=0, start=100.0):
    """Samples of one stream, with red at random; the recording's clock begins anywhere."""
    draw = random.Random(seed)
    times = [start + i * period for i in range(int(seconds / period))]
    robot = key.split("/")[0]
    return [Sample(robot, key, t, t, size, {"red": draw.random()}, i) for i, t in enumerate(times)]


def entered(flown, told, fates=None):
    """Take in samples, and send those for which `fates` says so, or all, as they come."""
    outcomes, first = Outcomes(flown), told[0].t
    for each in told:
        number, _ = outcomes.enter(each, each.t - first)
        if fates is None or fates(number):
            outcomes.send(number, each.t - first, each.t - first + flown.latency, "forwarded")
        else:
            outcomes.settle(number, "dropped:planner")
    return outcomes
