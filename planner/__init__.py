"""What is worth sending: evaluation model, constraints and search. Knows no Zenoh, no clock, no file."""

from planner.engines import start
from planner.errors import PlannerError, ProblemError, SearchError
from planner.problem import (
    Aggregation,
    AggregationModel,
    Constraint,
    Message,
    Problem,
    Receiver,
    Stream,
    Traffic,
)
from planner.search import Plan, Search, SearchSettings
from planner.utility import Linear, MessageUtility, Video

__all__ = [
    "Aggregation",
    "AggregationModel",
    "Constraint",
    "Linear",
    "Message",
    "MessageUtility",
    "Plan",
    "PlannerError",
    "Problem",
    "ProblemError",
    "Receiver",
    "Search",
    "SearchError",
    "SearchSettings",
    "Stream",
    "Traffic",
    "Video",
    "start",
]
