"""What can be wrong with ns-3."""

PACKAGE = "ns3==3.44.post0"
"""That the shim is written for."""
INSTALL = f"pip install --no-deps {PACKAGE}"
"""Without what its Python bindings need, which the shim does without."""


class Ns3Unavailable(RuntimeError):  # noqa: N818 -- a state, not a fault
    """ns-3 or the compiler for its shim is missing. Say what to do."""
