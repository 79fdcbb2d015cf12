"""A small mission: two robots that generate once a second, of whom one may send in any second."""

import json

from studies.bench.format import FORMAT

HEAD = {
    "format": FORMAT,
    "name": "small",
    "about": "two robots",
    "seconds": 12.0,
    "warm_up": 2.0,
    "latency": 0.05,
    "loss": 0.0,
    "seed": 1,
    "limits": [{"kind": "throughput", "limit": 15_000.0, "window": 0.9}],
    "columns": ["t_gen", "stream", "size"],
    "bound": 20.0,
    "all": 25.0,
}
STREAM = {
    "robot": "r0",
    "key": "r0/pose",
    "aggregation": "most_recent",
    "weight": 1.0,
    "utility": {"kind": "linear", "u0": 1.0, "slope": 0.5},
}


def lines(head=None, **changes):
    """The lines of the file, as objects; `changes` are of the head."""
    rows = [[second + 0.25 * robot, robot, 10_000] for second in range(12) for robot in range(2)]
    other = STREAM | {"robot": "r1", "key": "r1/pose", "weight": 3.0}
    return [head or HEAD | changes, STREAM, other, *rows]


def write(path, given=None):
    """Write a mission, or these lines of one."""
    path.write_text("".join(f"{json.dumps(line)}\n" for line in given or lines()))
    return path
