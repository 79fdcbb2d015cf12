"""Coverage-guided fuzzing of what comes over the mesh and of what operators write; `tests/fuzz/run` starts it.

The first argument says what: `mesh`, `specs` or `expressions`. The others are those of libFuzzer: folders of inputs,
options.
"""

import sys
from importlib.machinery import PathFinder
from pathlib import Path

import atheris

import planner  # noqa: F401 - with its native parts, which only the finder of the installation knows

# Atheris instruments what Python's own finder finds, and sees little of what others do.
sys.meta_path[:] = [finder for finder in sys.meta_path if finder is PathFinder or isinstance(finder, type)]
with atheris.instrument_imports(include=["proxy.core", "utility_specs"]):
    from tests.fuzz.spec_target import expression_seeds, file_seeds, one_expression, one_file
    from tests.fuzz.target import one_input
    from tests.utility_specs.heavy_specs import HEAVY

TARGETS = {
    "mesh": (one_input, list),
    "specs": (one_file, lambda: [*file_seeds(), *(text.encode() for text in HEAVY.values())]),
    "expressions": (one_expression, expression_seeds),
}

if __name__ == "__main__":
    target, seeds = TARGETS[sys.argv.pop(1)]
    kept = Path(sys.argv[1])
    kept.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(seeds()):
        (kept / f"seed-{number}").write_bytes(seed)
    atheris.Setup(sys.argv, target)
    atheris.Fuzz()
