"""Coverage-guided fuzzing of what comes over the mesh, from applications and operators; `tests/fuzz/run` starts it.

The first argument says what, as `targets.py` names it. The others are those of libFuzzer: folders of inputs, options.
"""

import sys
from importlib.machinery import PathFinder
from pathlib import Path

import atheris

import planner  # noqa: F401 - with its native parts, which only the finder of the installation knows

# Atheris instruments what Python's own finder finds, and sees little of what others do.
sys.meta_path[:] = [finder for finder in sys.meta_path if finder is PathFinder or isinstance(finder, type)]
with atheris.instrument_imports(include=["proxy", "utility_specs", "studies", "mcap", "rosbags"]):
    from tests.fuzz.targets import TARGETS

if __name__ == "__main__":
    target, seeds = TARGETS[sys.argv.pop(1)]
    kept = Path(sys.argv[1])
    kept.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(seeds()):
        (kept / f"seed-{number}").write_bytes(seed)
    atheris.Setup(sys.argv, target)
    atheris.Fuzz()
