"""Statuses as real daemons said them, and the same a while later."""

import copy
import json
from pathlib import Path

RECORDED = Path(__file__).parents[1] / "status" / "recorded"
R1, R2, R3 = (json.loads((RECORDED / f"{name}.json").read_text()) for name in ("r1", "r2", "r3"))


def later(status, seconds=2.0, made=20, sent=12):
    """The same daemon after some seconds: of each stream so many more samples were made and sent."""
    after = copy.deepcopy(status)
    after["uptime"] += seconds
    for stream in after["streams"]:
        stream["generated"] += made
        stream["forwarded"] += sent
        if stream["robot"] == after["robot"]:
            reasons = stream["by_reason"]
            reasons["dropped:planner"] = reasons.get("dropped:planner", 0) + made - sent
    counts, decisions = after["counts"], after["decisions"]
    counts["in"] += 60
    counts["forwarded"] += 36
    counts["dropped"] += 24
    counts["by_reason"]["dropped:planner"] += 20
    counts["by_reason"]["dropped:constraint"] += 4
    decisions["made"] += 10
    decisions["seconds"] += 0.05
    return after
