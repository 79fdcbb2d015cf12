"""Coverage-guided fuzzing of what comes over the mesh; `tests/fuzz/run` starts it.

Its arguments are those of libFuzzer: folders of inputs, options.
"""

import sys

import atheris

with atheris.instrument_imports(include=["proxy.core"], enable_loader_override=False):
    from tests.fuzz.target import one_input

if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
