"""Coverage-guided fuzzing of what comes over the mesh; `tests/fuzz/run` starts it.

Its arguments are those of libFuzzer: folders of inputs, options.
"""

import sys
from importlib.machinery import PathFinder

import atheris

import utility_specs  # noqa: F401 - with its native parts, which only the finder of the installation knows

# Atheris instruments what Python's own finder finds, and sees little of what others do.
sys.meta_path[:] = [finder for finder in sys.meta_path if finder is PathFinder or isinstance(finder, type)]
with atheris.instrument_imports(include=["proxy.core"]):
    from tests.fuzz.target import one_input

if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
