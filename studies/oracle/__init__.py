"""The offline optimum: what could have been gained by somebody who knew everything beforehand.

    bound = upper_bound(problem)              # linear programme: no plan is worth more; takes seconds
    best = optimum(problem, time_limit=30)    # integer programme: the best plan; for short missions

Both take a problem of the planner, of any aggregations, receivers and constraints, and decide all of its open
messages at once (`aggregations/` holds how, `windows.py` what the channel allows). They refuse an aggregation of the
caller's own that makes too many states of its messages. SciPy is imported when it is needed; without it they raise
OracleUnavailable.
"""

from studies.oracle.errors import OracleError, OracleFailed, OracleUnavailable
from studies.oracle.solution import Solution, optimum, upper_bound

__all__ = ["OracleError", "OracleFailed", "OracleUnavailable", "Solution", "optimum", "upper_bound"]
