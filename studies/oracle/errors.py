"""What can keep the oracle from answering."""

from proxy.extras import needs


class OracleError(Exception):
    """Base of all errors that the oracle raises."""


class OracleUnavailable(OracleError):  # noqa: N818 - a state of the installation, not a fault of the caller
    """SciPy is not installed; a report leaves the figure out and says why."""

    def __init__(self) -> None:
        super().__init__(f"the offline optimum {needs('study')}")


class OracleFailed(OracleError):  # noqa: N818 - as above
    """The solver gave no answer, for example because its time was up before it found any plan."""
