"""Chooses an engine and a search for a problem."""

from planner.problem import Problem
from planner.search import Search, SearchSettings
from planner.settings import check_settings


def start(problem: Problem, settings: SearchSettings, seed: int = 0) -> Search:
    """Start a search; raise ProblemError or SearchError when it has no meaning.

    The same problem, settings and seed give the same tree on either engine. Neither search draws random
    numbers today, so that equal views give equal plans; the seed is for evaluation models that sample. A stream
    whose own aggregation has more states than a table holds is for the Python engine, whatever the settings say.
    """
    from planner.native_engine import NativeSearch  # here: 2 MB that who never searches does without
    from planner.tables import tabulate

    del seed
    check_settings(settings)
    tables = tabulate(problem, beyond=settings.search == "best")
    if settings.engine == "native" and tables.closed:
        return NativeSearch(tables, settings)
    from planner.python_engine.best import BestSearch
    from planner.python_engine.paper import PaperSearch

    return PaperSearch(tables, settings) if settings.search == "paper" else BestSearch(tables, settings)
