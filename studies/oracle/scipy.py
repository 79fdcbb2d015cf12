"""SciPy, imported when it is needed: it belongs to the extra "study"."""

import importlib
from types import ModuleType

from studies.oracle.errors import OracleUnavailable


def load(part: str) -> ModuleType:
    """Import `scipy.<part>`; raise OracleUnavailable when SciPy is not installed."""
    try:
        return importlib.import_module(f"scipy.{part}")
    except ImportError as error:
        raise OracleUnavailable from error
