"""What is worth sending: evaluation model, constraints and search. Knows no Zenoh, no clock, no file."""

from planner.airtime import Airtime
from planner.engines import start
from planner.errors import PlannerError, ProblemError, SearchError
from planner.measures import Energy, Measure, Messages, Throughput
from planner.problem import (
    Aggregation,
    AggregationModel,
    Constraint,
    Latest,
    Message,
    Problem,
    Receiver,
    Stream,
    Traffic,
)
from planner.search import Plan, Search, SearchSettings
from planner.utility import Custom, Exponential, Linear, MessageUtility, Polynomial, Power, Step, Table, Video

__all__ = [
    "Aggregation",
    "AggregationModel",
    "Airtime",
    "Constraint",
    "Custom",
    "Energy",
    "Exponential",
    "Latest",
    "Linear",
    "Measure",
    "Message",
    "MessageUtility",
    "Messages",
    "Plan",
    "PlannerError",
    "Polynomial",
    "Power",
    "Problem",
    "ProblemError",
    "Receiver",
    "Search",
    "SearchError",
    "SearchSettings",
    "Step",
    "Stream",
    "Table",
    "Throughput",
    "Traffic",
    "Video",
    "start",
]
