"""Message utility functions: value per second at an age, and their closed-form integrals (§2.2)."""

from planner.utility.base import Batched, Flags, Floats, Ints, MessageUtility
from planner.utility.custom import Custom
from planner.utility.exponential import Exponential
from planner.utility.integral import STANDARD, integral
from planner.utility.linear import Linear
from planner.utility.polynomial import Polynomial
from planner.utility.power import Power
from planner.utility.step import Step
from planner.utility.table import Table
from planner.utility.video import Video

__all__ = [
    "STANDARD",
    "Batched",
    "Custom",
    "Exponential",
    "Flags",
    "Floats",
    "Ints",
    "Linear",
    "MessageUtility",
    "Polynomial",
    "Power",
    "Step",
    "Table",
    "Video",
    "integral",
]
