"""Keeps a daemon from loading OpenSSL, which is 3.5 MB of it, for hashes that Python has itself.

Pydantic imports `secrets`, that imports `hashlib`, and that loads OpenSSL unless there is none.
"""

import sys

BINDING = "_hashlib"
"""Python's module that binds OpenSSL's hashes: `hashlib` and `hmac` do without where it cannot be imported."""


def leave_out() -> None:
    """Have `hashlib` use Python's own hashes, if it was not imported before."""
    if "hashlib" not in sys.modules:
        # With None in its place Python says that it cannot be imported.
        sys.modules.setdefault(BINDING, None)  # type: ignore[arg-type]
