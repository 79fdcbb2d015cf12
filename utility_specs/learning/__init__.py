"""A first utility spec from traffic that was observed: what there is, how it comes, what could matter in it.

Pure: samples come in as data, and the text of a spec file comes out.
"""

from collections.abc import Callable, Iterable, Sequence

from utility_specs.learning.formats import ros_topic
from utility_specs.learning.observed import Observed
from utility_specs.learning.patterns import kinds_of
from utility_specs.learning.stream import Timing
from utility_specs.learning.traffic import MOST_STREAMS, Traffic
from utility_specs.learning.writing import spec_file

__all__ = ["LearningError", "Observed", "Timing", "learn"]

ROS_2 = (
    'In the configuration of the daemon, profile = "ros2" keeps rosout, parameter_events and tf of ROS 2 on the robot,'
    " and lets commands and latched topics bypass the planner: what is said of them here is then without effect."
)


class LearningError(Exception):
    """Nothing can be learned from what was seen."""


def learn(
    samples: Iterable[Observed],
    timing: Callable[[], Timing],
    robots: Sequence[str] = (),
    notes: Callable[[], Sequence[str]] = tuple,
) -> str:
    """Return a spec for what was seen, in the order of time. Raises LearningError when nothing was.

    `timing` makes what finds out how one stream generates. Chunks of keys that are names of `robots` stand for any
    robot. `notes`, asked when all samples were read, are said at the top of the spec.
    """
    traffic = Traffic.of(samples, timing)
    if not traffic.count:
        raise LearningError("there are no samples to learn from")
    limits = [
        (traffic.odd, "of the samples, as no spec can name their keys"),
        (traffic.untold, f"of the samples, of more than {MOST_STREAMS} streams"),
    ]
    left_out = [f"Left out: {count} {what}." for count, what in limits if count]
    ros = [ROS_2] if any(ros_topic(stream.key) for stream in traffic.streams) else []
    return spec_file(traffic, kinds_of(traffic.streams, robots), robots, [*notes(), *left_out, *ros])
