"""A plain Zenoh application: publishes the charge of a battery ten times a second, and prints what other robots say.

`python hello.py ROBOT`, with client.json5 beside it. It knows nothing of Sendworthy.
"""

import json
import sys
import time
from pathlib import Path

import zenoh

robot = sys.argv[1]


def hear(sample: zenoh.Sample) -> None:
    """Print what comes, but for what this robot says itself."""
    if str(sample.key_expr) != f"robot/{robot}/battery":
        print(sample.key_expr, sample.payload.to_string(), flush=True)


with zenoh.open(zenoh.Config.from_file(str(Path(__file__).with_name("client.json5")))) as session:
    session.declare_subscriber("robot/*/battery", hear)
    for number in range(10_000):
        session.put(f"robot/{robot}/battery", json.dumps({"charge": 1 - number / 10_000}))
        time.sleep(0.1)
