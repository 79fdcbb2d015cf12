"""Both engines of an installed planner grow the same trees, as a program: it needs no more than the installation.

    python agreement.py [WINDOWS]

Prints what is decided, a line of JSON for each window and mode, for another machine to compare. Ends with 1 at the
first window that the engines disagree on.
"""

import dataclasses
import json
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))  # at the end: the planner is the installed one, not the one beside it

from planner import Aggregation, SearchSettings, start
from tests.planner.windows import window

MODES = (("best", "off"), ("paper", "off"), ("paper", "paper"), ("paper", "exact"))
ITERATIONS = 120


def main(count=60):
    """Plan so many windows, in all modes; return the exit code."""
    for seed in range(count):
        problem = window(
            seed,
            robots=1 + seed % 5,
            horizon=4 + seed % 17,
            constraints=seed % 3,
            grid=seed % 2 == 0,
            aggregations=tuple(Aggregation),
        )
        for search, reduction in MODES:
            settings = SearchSettings(search=search, reduction=reduction)
            python, native = (grown(problem, settings, engine) for engine in ("python", "native"))
            if python.tree() != native.tree() or python.plan() != native.plan():
                print(f"the engines disagree on window {seed}, {search} {reduction}", file=sys.stderr)
                return 1
            print(json.dumps({"window": seed, "mode": [search, reduction], **dataclasses.asdict(native.plan())}))
    return 0


def grown(problem, settings, engine):
    """A search that has run."""
    search = start(problem, dataclasses.replace(settings, engine=engine), seed=1)
    search.run(ITERATIONS)
    return search


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
