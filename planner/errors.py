"""What can be wrong with a problem or a search; every message says what to do."""


class PlannerError(Exception):
    """Base of all errors that the planner raises."""


class ProblemError(PlannerError, ValueError):
    """A planning problem that has no meaning: NaN, a negative size, times out of order, an unknown stream."""


class SearchError(PlannerError, ValueError):
    """Search settings that cannot be used: an unknown mode, no room for a tree."""
