"""How right the shared view is on bad networks, and what a team reaches with it."""

from studies.benchmarks.view.page import measure_view

__all__ = ["measure_view"]
